#include "report/page.h"

#include <fmt/format.h>

#include "core/json_text.h"
#include "report/bundle.h"
#include "report/html.h"

namespace rigmap {
namespace {

// The headings of the sections, as links.
std::string Contents(const std::vector<std::string>& sections) {
  std::string links;
  for (const std::string& section : sections) {
    const auto id = section.find("<section id=\"");
    const auto heading = section.find("<h2>");
    if (id == std::string::npos || heading == std::string::npos) continue;
    const auto id_start = id + 13;
    links += fmt::format("<a href=\"#{}\">{}</a>\n",
                         section.substr(id_start, section.find('"', id_start) - id_start),
                         section.substr(heading + 4, section.find("</h2>") - heading - 4));
  }
  return "<nav aria-label=\"Sections\">" + links + "</nav>\n";
}

// Nothing may be fetched: not even by a text that got past the escaping.
constexpr const char* kPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

}  // namespace

std::string WritePage(const Page& page) {
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n"
      "<link rel=\"icon\" href=\"data:,\">\n<style>\n{}</style>\n</head>\n<body>\n<main>\n",
      kPolicy, Escaped(page.title), ReportStyle());
  for (std::size_t i = 0; i < page.sections.size(); ++i) {
    text += page.sections[i];
    if (i == 0) text += Contents(page.sections);
  }
  text += "</main>\n";
  if (!ReportScripts().empty()) {
    text += "<script type=\"application/json\" id=\"report-data\">";
    text += EscapedJson(JsonText(page.data));
    text += "</script>\n";
    for (std::size_t i = 0; i < page.points.size(); ++i) {
      // The coarsest level before the scripts, so that it is there when they begin.
      if (i == 1) text += fmt::format("<script>{}</script>\n", ReportScripts());
      text += fmt::format("<script type=\"text/plain\" id=\"points-{}\">{}</script>\n", i,
                          page.points[i]);
    }
    if (page.points.size() < 2) text += fmt::format("<script>{}</script>\n", ReportScripts());
  }
  return text + "</body>\n</html>\n";
}

}  // namespace rigmap
