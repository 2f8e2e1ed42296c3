#include "report/html.h"

#include <fmt/format.h>

namespace rigmap {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char character : text) {
    switch (character) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += static_cast<unsigned char>(character) < ' ' ? ' ' : character;
    }
  }
  return escaped;
}

std::string EscapedJson(std::string json) {
  std::string escaped;
  for (const char character : json) {
    if (character == '<') {
      escaped += "\\u003c";
    } else {
      escaped += character;
    }
  }
  return escaped;
}

std::string HtmlSection(const char* id, const char* title, const std::string& lead,
                        const std::string& body) {
  if (body.empty()) return "";
  const std::string said = lead.empty() ? "" : fmt::format("<p class=\"lead\">{}</p>\n", lead);
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}{}</section>\n", id, title, said, body);
}

HtmlTable::HtmlTable(const std::vector<std::string>& headings) {
  for (const std::string& heading : headings) headings_ += fmt::format("<th>{}</th>", heading);
}

void HtmlTable::Row(const std::vector<std::string>& cells, const char* row_class) {
  rows_ += *row_class ? fmt::format("<tr class=\"{}\">", row_class) : "<tr>";
  for (const std::string& cell : cells) rows_ += fmt::format("<td>{}</td>", cell);
  rows_ += "</tr>\n";
}

std::string HtmlTable::Text() const {
  if (rows_.empty()) return "";
  return fmt::format(
      "<div class=\"table\"><table><thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      headings_, rows_);
}

}  // namespace rigmap
