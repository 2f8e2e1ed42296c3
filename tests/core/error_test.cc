#include "core/error.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TEST(Legible, LeavesPlainSentencesAlone) {
  const std::string sentence = "/data/times.txt:3: expected a time, found 'zwölf'";
  EXPECT_EQ(Legible(sentence), sentence);
}

TEST(Legible, IsOneLineOfPrintableCharacters) {
  using namespace std::string_view_literals;
  EXPECT_EQ(Legible("found '\0\x01\x7f', then\nmore\r"sv),
            "found '\\x00\\x01\\x7f', then\\nmore\\x0d");
}

TEST(Legible, KeepsBothEndsOfWhatIsTooLong) {
  const std::string found = Legible("begin " + std::string(100000, '\0') + " end");
  EXPECT_TRUE(found.starts_with("begin \\x00"));
  EXPECT_TRUE(found.ends_with("\\x00 end"));
  EXPECT_LT(found.size(), 4000U);
}

// A sentence with a zero byte in it would end there.
TEST(Error, SaysAllOfItsSentence) {
  const DataError error("found 'a" + std::string(1, '\0') + "b', expected a time");
  EXPECT_STREQ(error.what(), "found 'a\\x00b', expected a time");
}

}  // namespace
}  // namespace rigmap
