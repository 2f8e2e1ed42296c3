#include "core/option_documents.h"

#include <gmock/gmock.h>

#include <array>
#include <sstream>

namespace rigmap {
namespace {

using testing::HasSubstr;

enum class Tint { kRed, kBlue };
constexpr auto NamesOf(Tint) { return std::array{"red", "blue"}; }

class OptionDocuments : public testing::Test {
 protected:
  std::vector<OptionSection> Sections() {
    return {{"first",
             "About the first.",
             {{"side_m", &side_m_, "m", MoreThan(0.0), "Why " + long_},
              {"colour", ChoiceOf(&colour_), "", {}, "red | blue."}}},
            {"second", "About the second.", {{"on", &on_, "", {}, "Whether."}}}};
  }

  double side_m_ = 0.25;
  Tint colour_ = Tint::kBlue;
  bool on_ = true;
  std::string long_ =
      "it is so: word word word word word word word word word word word word word word.";
};

TEST_F(OptionDocuments, YamlExplainsEachOptionAboveIt) {
  EXPECT_EQ(OptionsYaml("On top.", Sections()),
            "# On top.\n"
            "\n"
            "# About the first.\n"
            "first:\n"
            "  # (m; more than 0) Why it is so: word word word word word word word word word word "
            "word word word\n"
            "  # word.\n"
            "  side_m: 0.25\n"
            "  # (red or blue) red | blue.\n"
            "  colour: blue\n"
            "\n"
            "# About the second.\n"
            "second:\n"
            "  # (true or false) Whether.\n"
            "  on: true\n");
}

TEST_F(OptionDocuments, YamlReadsBackToTheSameValues) {
  const std::string text = OptionsYaml("On top.", Sections());
  side_m_ = 1.0;
  colour_ = Tint::kRed;
  const YamlNode file = ParseYaml(text, "f");
  ReadOptions(file.At("first"), Sections()[0].fields);
  EXPECT_EQ(side_m_, 0.25);
  EXPECT_EQ(colour_, Tint::kBlue);
}

TEST_F(OptionDocuments, MarkdownHasARowForEachOption) {
  const std::string text = OptionsMarkdown("# Options\n", Sections());
  EXPECT_THAT(text, testing::StartsWith("# Options\n\n## first\nAbout the first.\n\n| option"));
  EXPECT_THAT(text, HasSubstr("\n| `side_m` | 0.25 | m | more than 0 | Why it is so"));
  EXPECT_THAT(text, HasSubstr("\n| `colour` | blue |  | red or blue | red \\| blue. |\n"));
}

TEST_F(OptionDocuments, HelpNamesEachOptionWithItsValue) {
  EXPECT_EQ(OptionsHelp(Sections()), "  first: side_m=0.25 colour=blue\n  second: on=true\n");
}

}  // namespace
}  // namespace rigmap
