#include "core/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace rigmap {
namespace {

// A folder may bear a name in Latin-1.
TEST(JsonText, IsJsonWhateverTheStringsHold) {
  const nlohmann::ordered_json json = {{"dataset", "/data/d\xfcne"}, {"parts", 2}};
  const std::string text = JsonText(json);
  const auto read = nlohmann::json::parse(text);
  EXPECT_EQ(read["dataset"], "/data/d\xEF\xBF\xBDne");
  EXPECT_EQ(read["parts"], 2);
  EXPECT_EQ(JsonText(nlohmann::json{1}, 1), "[\n 1\n]");
}

// Sentences are cut where they are too long; a letter of several bytes must not be.
TEST(JsonText, TakesLongSentencesAsTheyAre) {
  for (int shift = 0; shift < 3; ++shift) {
    std::string sentence(static_cast<std::size_t>(shift), 'a');
    for (int i = 0; i < 1000; ++i) sentence += "\xE2\x82\xAC";  // the euro's sign
    const nlohmann::json json = Legible(sentence);
    EXPECT_NO_THROW(static_cast<void>(json.dump())) << shift;
  }
}

}  // namespace
}  // namespace rigmap
