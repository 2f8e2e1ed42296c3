// Text as HTML that cannot be anything else.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rigmap {

// For element content and quoted attributes: & < > " ' become entities, control characters blanks.
std::string Escaped(std::string_view text);

// JSON for a script element: no '<' in it, so that nothing ends the element.
std::string EscapedJson(std::string json);

// <section id="ID"><h2>TITLE</h2><p class="lead">LEAD</p>BODY</section>; empty without a body.
// `lead` and `body` are HTML.
std::string HtmlSection(const char* id, const char* title, const std::string& lead,
                        const std::string& body);

// A table with a heading row; cells are HTML. Wide ones scroll by themselves.
class HtmlTable {
 public:
  explicit HtmlTable(const std::vector<std::string>& headings);
  void Row(const std::vector<std::string>& cells, const char* row_class = "");
  bool empty() const { return rows_.empty(); }
  std::string Text() const;

 private:
  std::string headings_, rows_;
};

}  // namespace rigmap
