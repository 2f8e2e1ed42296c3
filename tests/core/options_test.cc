#include "core/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct SampleOptions {
  int count = 3;
  double share = 0.1;
  bool on = false;
  std::string name = "sift";
  OptionFields Fields() {
    return {{"count", &count}, {"share", &share}, {"on", &on}, {"name", &name}};
  }
  bool operator==(const SampleOptions&) const = default;
};

SampleOptions WrittenAndRead(SampleOptions options) {
  SampleOptions copy{.count = 0, .share = 0.0, .on = !options.on, .name = "?"};
  const auto root = ParseYaml("sample:\n" + WriteOptions(options.Fields()), "f");
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
                                .name = "sift"};
    EXPECT_EQ(WrittenAndRead(options), options);
  }
}

TEST(OptionsTest, TextOfAnyKindReadsBack) {
  for (const std::string name : {"", "a: b # c", "say \"yes\"", "C:\\data", "two\nlines"}) {
    EXPECT_EQ(WrittenAndRead({.name = name}).name, name);
  }
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
      "f.yaml:1: expected true or false, found '7'");
}

TEST(OptionsTest, SetAssignsOneField) {
  SampleOptions options;
  SetOption("sample", "count", "-4", options.Fields());
  SetOption("sample", "share", "1e-3", options.Fields());
  SetOption("sample", "on", "true", options.Fields());
  SetOption("sample", "name", "a=b", options.Fields());
  EXPECT_EQ(options, (SampleOptions{.count = -4, .share = 1e-3, .on = true, .name = "a=b"}));
}

TEST(OptionsTest, SetRefusesUnknownNamesAndWrongValuesAsUsage) {
  SampleOptions options;
  EXPECT_THAT(MessageOf<UsageError>([&] { SetOption("sample", "x", "1", options.Fields()); }),
              StartsWith("--set sample.x: unknown option"));
  EXPECT_THAT(MessageOf<UsageError>([&] { SetOption("sample", "count", "1.5", options.Fields()); }),
              HasSubstr("--set sample.count: expected an integer, found '1.5'"));
  EXPECT_EQ(options, SampleOptions{});
}

TEST(OptionsTest, RequirementThatFailsIsUsage) {
  EXPECT_NO_THROW(RequireOption(true, "share", "at most 1", 0.5));
  EXPECT_EQ(MessageOf<UsageError>([] { RequireOption(false, "share", "at most 1", 2.5); }),
            "option share: expected at most 1, found 2.5");
}

}  // namespace
}  // namespace rigmap
