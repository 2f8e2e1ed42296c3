#include "report/bundle.h"

#include <cstddef>

// The files lie in the program's read-only data as they are.
asm(".section .rodata\n"
    "rigmap_report_style:\n.incbin \"" REPORT_STYLE
    "\"\nrigmap_report_style_end:\n.byte 0\n"
    "rigmap_report_scripts:\n.incbin \"" REPORT_BUNDLE
    "\"\nrigmap_report_scripts_end:\n.byte 0\n"
    ".previous\n");

extern "C" {
extern const char rigmap_report_style[], rigmap_report_style_end[];
extern const char rigmap_report_scripts[], rigmap_report_scripts_end[];
}

namespace rigmap {

std::string_view ReportStyle() {
  return {rigmap_report_style,
          static_cast<std::size_t>(rigmap_report_style_end - rigmap_report_style)};
}

std::string_view ReportScripts() {
  return {rigmap_report_scripts,
          static_cast<std::size_t>(rigmap_report_scripts_end - rigmap_report_scripts)};
}

}  // namespace rigmap
