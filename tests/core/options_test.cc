#include "core/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::StartsWith;

enum class Colour { kRed, kDeepBlue };
constexpr auto NamesOf(Colour) { return std::array{"red", "deep-blue"}; }

struct SampleOptions {
  static constexpr const char* kSection = "sample";

  int count = 3;
  double share = 0.1;
  bool on = false;
  Colour colour = Colour::kDeepBlue;
  int side_px = 5;

  OptionFields Fields() {
    return {{"count", &count, "", {}, "How many."},
            {"share", &share, "", MoreThan(0.0), "How much."},
            {"on", &on, "", {}, "Whether."},
            {"colour", ChoiceOf(&colour), "", {}, "Which."},
            {"side_px", &side_px, "px", AtLeast(3).UpTo(9).Odd(), "How wide."}};
  }
  void RequireRelations() const {
    RequireOption(count != side_px, "sample.count", "another than sample.side_px", count);
  }
  bool operator==(const SampleOptions&) const = default;
};

SampleOptions WrittenAndRead(const SampleOptions& options) {
  SampleOptions copy{.count = 0, .share = 1.0, .on = !options.on, .colour = Colour::kRed};
  const auto root = ParseYaml("sample:\n" + OptionsText(options), "f");
  ReadOptions(root.At("sample"), copy.Fields());
  return copy;
}

TEST(OptionsTest, WriteAndReadAreInverse) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponents(-300.0, 300.0);
  for (int i = 0; i < 200; ++i) {
    const SampleOptions options{.count = static_cast<int>(random()),
                                .share = std::pow(10.0, exponents(random)),
                                .on = i % 2 == 0,
                                .colour = i % 3 == 0 ? Colour::kRed : Colour::kDeepBlue,
                                .side_px = 3 + 2 * (i % 4)};
    EXPECT_EQ(WrittenAndRead(options), options);
  }
}

TEST(OptionsTest, TextHasALineForEachField) {
  EXPECT_EQ(OptionsText(SampleOptions{}),
            "  count: 3\n  share: 0.1\n  on: false\n  colour: deep-blue\n  side_px: 5\n");
}

TEST(OptionsTest, WholeNumbersServeAsDoubles) {
  SampleOptions options;
  ReadOptions(ParseYaml("share: 2", "f"), options.Fields());
  EXPECT_EQ(options.share, 2.0);
}

TEST(OptionsTest, WhatIsNotNamedKeepsItsDefault) {
  SampleOptions options;
  ReadOptions(ParseYaml("count: 8", "f"), options.Fields());
  EXPECT_EQ(options, SampleOptions{.count = 8});
  ReadOptions(ParseYaml("", "f"), options.Fields());
  EXPECT_EQ(options, SampleOptions{.count = 8});
}

TEST(OptionsTest, UnknownKeyIsAnErrorWithItsLine) {
  SampleOptions options;
  const auto root = ParseYaml("count: 8\ncuont: 9\n", "f.yaml");
  EXPECT_THAT(MessageOf<DataError>([&] { ReadOptions(root, options.Fields()); }),
              StartsWith("f.yaml:2: unknown option 'cuont', expected one of count, share"));
}

TEST(OptionsTest, SectionMustBeAMap) {
  SampleOptions options;
  for (const char* text : {"sample: 5", "sample: [count]"}) {
    EXPECT_THAT(MessageOf<DataError>(
                    [&] { ReadOptions(ParseYaml(text, "f").At("sample"), options.Fields()); }),
                StartsWith("f:1: expected a map"));
  }
}

TEST(OptionsTest, WrongKindOfValueIsAnErrorWithItsLine) {
  SampleOptions options;
  EXPECT_EQ(
      MessageOf<DataError>([&] { ReadOptions(ParseYaml("on: 7", "f.yaml"), options.Fields()); }),
      "f.yaml:1: option on: expected true or false, found '7'");
  EXPECT_EQ(MessageOf<DataError>(
                [&] { ReadOptions(ParseYaml("count: [1, 2]", "f.yaml"), options.Fields()); }),
            "f.yaml:1: option count: expected an integer, found a list of 2");
}

TEST(OptionsTest, ValueThatIsNotAllowedIsUsageWithItsLine) {
  const auto message = [](const std::string& text) {
    SampleOptions options;
    return MessageOf<UsageError>(
        [&] { ReadOptions(ParseYaml("on: true\n" + text, "f.yaml"), options.Fields()); });
  };
  EXPECT_EQ(message("share: 0"), "f.yaml:2: option share: expected more than 0, found 0");
  EXPECT_EQ(message("side_px: 4"), "f.yaml:2: option side_px: expected 3 to 9, odd, found 4");
  EXPECT_EQ(message("colour: blue"),
            "f.yaml:2: option colour: expected red or deep-blue, found 'blue'");
}

TEST(OptionsTest, SetAssignsOneField) {
  SampleOptions options;
  SetOption("sample", "count", "-4", options.Fields());
  SetOption("sample", "share", "1e-3", options.Fields());
  SetOption("sample", "on", "true", options.Fields());
  SetOption("sample", "colour", "red", options.Fields());
  EXPECT_EQ(options,
            (SampleOptions{.count = -4, .share = 1e-3, .on = true, .colour = Colour::kRed}));
}

TEST(OptionsTest, SetRefusesUnknownNamesAndWrongValuesAsUsage) {
  const auto message = [](const std::string& option, const std::string& value) {
    SampleOptions options;
    return MessageOf<UsageError>([&] { SetOption("sample", option, value, options.Fields()); });
  };
  EXPECT_THAT(message("x", "1"), StartsWith("--set sample.x: unknown option"));
  EXPECT_THAT(message("count", "1.5"),
              StartsWith("--set sample.count: expected an integer, found '1.5'"));
  EXPECT_EQ(message("share", "-2"), "--set sample.share: expected more than 0, found -2");
  EXPECT_EQ(message("colour", "a=b"),
            "--set sample.colour: expected red or deep-blue, found 'a=b'");
}

TEST(OptionsTest, RequireValidChecksRangesAndRelations) {
  EXPECT_NO_THROW(RequireValid(SampleOptions{}));
  EXPECT_EQ(MessageOf<UsageError>([] { RequireValid(SampleOptions{.share = -0.5}); }),
            "option sample.share: expected more than 0, found -0.5");
  EXPECT_EQ(MessageOf<UsageError>([] { RequireValid(SampleOptions{.count = 5}); }),
            "option sample.count: expected another than sample.side_px, found 5");
}

TEST(OptionsTest, RequirementThatFailsIsUsage) {
  EXPECT_NO_THROW(RequireOption(true, "share", "at most 1", 0.5));
  EXPECT_EQ(MessageOf<UsageError>([] { RequireOption(false, "share", "at most 1", 2.5); }),
            "option share: expected at most 1, found 2.5");
}

}  // namespace
}  // namespace rigmap
