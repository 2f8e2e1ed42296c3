#include "core/yaml.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kText =
    "# comment\n"
    "scale:\n"
    "  max_spread: 0.02\n"
    "  on: true\n"
    "list: [1, 2.5, -3e-2]\n"
    "name: \"a b\"\n"
    "empty:\n";

TEST(YamlTest, EveryValueKnowsItsLine) {
  const YamlNode root = ParseYaml(kText, "f.yaml");
  EXPECT_EQ(root.At("scale").At("max_spread").where, "f.yaml:3");
  EXPECT_EQ(root.At("scale").At("on").where, "f.yaml:4");
  EXPECT_EQ(root.At("list").items.at(2).where, "f.yaml:5");
  EXPECT_EQ(root.At("empty").where, "f.yaml:7");
}

TEST(YamlTest, ReadsValues) {
  const YamlNode root = ParseYaml(kText, "f.yaml");
  EXPECT_EQ(root.At("scale").At("max_spread").AsDouble(), 0.02);
  EXPECT_TRUE(root.At("scale").At("on").AsBool());
  EXPECT_THAT(root.At("list").AsDoubles(3), testing::ElementsAre(1.0, 2.5, -0.03));
  EXPECT_EQ(root.At("name").AsString(), "a b");
  EXPECT_EQ(root.At("empty").kind, YamlNode::Kind::kNull);
  EXPECT_EQ(root.Find("missing"), nullptr);
}

TEST(YamlTest, ComplaintsNameLineExpectedAndFound) {
  const YamlNode root = ParseYaml(kText, "f.yaml");
  const auto message = [](const auto& deed) { return MessageOf<DataError>(deed); };
  EXPECT_EQ(message([&] { root.At("name").AsDouble(); }),
            "f.yaml:6: expected a finite number, found 'a b'");
  EXPECT_EQ(message([&] { root.At("scale").At("max_spread").AsInt(); }),
            "f.yaml:3: expected an integer, found '0.02'");
  EXPECT_EQ(message([&] { root.At("list").AsDoubles(4); }),
            "f.yaml:5: expected a list of 4 numbers, found a list of 3");
  EXPECT_EQ(message([&] { root.At("empty").AsBool(); }),
            "f.yaml:7: expected true or false, found nothing");
  EXPECT_THAT(message([&] { root.At("scale").At("mim"); }), HasSubstr("key 'mim' is missing"));
  EXPECT_THAT(message([&] { root.At("scale").RequireKeys({"on"}); }),
              StartsWith("f.yaml:3: unknown key 'max_spread'"));
}

TEST(YamlTest, NumbersMustBeFiniteAndWhole) {
  for (const char* text : {"x: .nan", "x: .inf", "x: inf", "x: nan", "x: 1e999", "x: 1.5m",
                           "x: ", "x: [1]", "x: {a: 1}", "x: 0x10"}) {
    EXPECT_THROW(ParseYaml(text, "f").At("x").AsDouble(), DataError) << text;
  }
  EXPECT_THROW(ParseYaml("x: 99999999999", "f").At("x").AsInt(), DataError);
  EXPECT_EQ(ParseYaml("x: +5.5", "f").At("x").AsDouble(), 5.5);
}

TEST(YamlTest, RefusesRepeatedKeysWithTheirLine) {
  EXPECT_EQ(MessageOf<DataError>([] { ParseYaml("a: 1\nb: 2\na: 3\n", "f"); }),
            "f:3: key 'a' stands twice");
}

TEST(YamlTest, RefusesMoreThanOneDocument) {
  EXPECT_EQ(MessageOf<DataError>([] { ParseYaml("a: 1\n---\na: 2\n", "f"); }),
            "f: expected one YAML document, found 2");
}

TEST(YamlTest, RefusesBrokenYamlWithItsLine) {
  EXPECT_THAT(MessageOf<DataError>([] { ParseYaml("a: 1\nb: [1, 2\nc: 3\n", "f"); }),
              StartsWith("f:"));
}

TEST(YamlTest, RefusesAnAliasThatHoldsItself) {
  EXPECT_THAT(MessageOf<DataError>([] { ParseYaml("a: &x [*x]\n", "f"); }),
              HasSubstr("nested deeper"));
}

// Ten lists of ten aliases each: ten billion values, which took all memory.
TEST(YamlTest, RefusesAliasesThatMultiplyWithinASecond) {
  std::string text = "l0: &l0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::vector<std::string> aliases(10, fmt::format("*l{}", i - 1));
    text += fmt::format("l{0}: &l{0} [{1}]\n", i, fmt::join(aliases, ", "));
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(MessageOf<DataError>([&] { ParseYaml(text, "f.yaml"); }),
              AllOf(StartsWith("f.yaml:"), HasSubstr("expected at most 100000 values"),
                    HasSubstr("found more")));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

TEST(YamlTest, AliasesOfAnHonestFileAreRead) {
  const YamlNode root = ParseYaml("a: &a [1, 2]\nb: *a\nc: [*a, *a]\n", "f");
  EXPECT_THAT(root.At("b").AsDoubles(2), testing::ElementsAre(1.0, 2.0));
  EXPECT_THAT(root.At("c").items.at(1).AsDoubles(2), testing::ElementsAre(1.0, 2.0));
}

TEST(YamlTest, MissingFileIsNamed) {
  const TemporaryFolder folder;
  const auto path = folder.Path() / "none.yaml";
  EXPECT_THAT(MessageOf<DataError>([&] { ReadYaml(path); }), HasSubstr(path.string()));
}

TEST(YamlTest, QuotedTextReadsBack) {
  for (const std::string text :
       {"", "plain", "a \"b\" c", "back\\slash\\", "tab\tline\nend", "# : [x]", "größer", "\x01"}) {
    const std::string line = fmt::format("x: {}\n", QuoteYaml(text));
    EXPECT_EQ(ParseYaml(line, "f").At("x").AsString(), text) << line;
    EXPECT_EQ(line.find('\n'), line.size() - 1);
  }
}

}  // namespace
}  // namespace rigmap
