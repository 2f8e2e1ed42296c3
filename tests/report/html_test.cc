#include "report/html.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace rigmap {
namespace {

TEST(HtmlTest, EscapesWhatCouldBeMoreThanText) {
  EXPECT_EQ(Escaped("<script>alert('a' & \"b\")</script>\n"),
            "&lt;script&gt;alert(&#39;a&#39; &amp; &quot;b&quot;)&lt;/script&gt; ");
  EXPECT_EQ(Escaped("1 % \u00b1 \u00e9"), "1 % \u00b1 \u00e9");
}

TEST(HtmlTest, JsonCannotEndItsElementAndStaysTheSame) {
  const nlohmann::json json = {{"name", "</script><!--"}};
  const std::string escaped = EscapedJson(json.dump());
  EXPECT_EQ(escaped.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(escaped), json);
}

TEST(HtmlTest, NothingToTellIsNothing) {
  EXPECT_EQ(HtmlTable({"What"}).Text(), "");
  EXPECT_EQ(HtmlSection("id", "Title", "Lead", ""), "");
}

}  // namespace
}  // namespace rigmap
