// What every report holds beside its own content: style, and scripts where the program was built
// with them.
#pragma once

#include <string_view>

namespace rigmap {

std::string_view ReportStyle();
// Empty where there was no node to bundle them: reports are plain then.
std::string_view ReportScripts();

}  // namespace rigmap
