#include "matching/internal/vocabulary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "matching/internal/place_index.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

Descriptor RandomDescriptor(SeededRandom& random) {
  Descriptor descriptor;
  for (auto& value : descriptor) value = static_cast<std::uint8_t>(random.Uniform(0.0, 120.0));
  return descriptor;
}

Descriptor SeenAgain(const Descriptor& descriptor, SeededRandom& random) {
  Descriptor noisy = descriptor;
  for (auto& value : noisy) {
    value = static_cast<std::uint8_t>(std::clamp(value + random.Normal(4.0), 0.0, 255.0));
  }
  return noisy;
}

std::vector<Descriptor> Some(int count, SeededRandom& random) {
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < count; ++i) descriptors.push_back(RandomDescriptor(random));
  return descriptors;
}

TEST(Vocabulary, TellsDescriptorsApartAndKnowsThemAgain) {
  SeededRandom random;
  const std::vector<Descriptor> sample = Some(3000, random);
  const Vocabulary vocabulary(sample);
  EXPECT_GT(vocabulary.word_count(), 200);
  std::set<int> words;
  int again = 0, same_branch = 0;
  for (const Descriptor& descriptor : sample) {
    const int word = vocabulary.WordOf(descriptor);
    ASSERT_GE(word, 0);
    ASSERT_LT(word, vocabulary.word_count());
    words.insert(word);
    const Descriptor noisy = SeenAgain(descriptor, random);
    again += vocabulary.WordOf(noisy) == word ? 1 : 0;
    same_branch += vocabulary.BranchOf(noisy) == vocabulary.BranchOf(descriptor) ? 1 : 0;
  }
  EXPECT_GT(words.size(), 200u);
  EXPECT_GT(again, 1500);
  EXPECT_GT(same_branch, 2250);
}

TEST(Vocabulary, IsTheSameForTheSameSample) {
  SeededRandom random;
  const std::vector<Descriptor> sample = Some(500, random);
  const Vocabulary one(sample), other(sample);
  for (const Descriptor& descriptor : sample) {
    EXPECT_EQ(one.WordOf(descriptor), other.WordOf(descriptor));
  }
}

TEST(Vocabulary, TwinsAndEmptySamplesMakeOneWord) {
  EXPECT_EQ(Vocabulary({}).word_count(), 1);
  const std::vector<Descriptor> twins(100, Descriptor{});
  EXPECT_EQ(Vocabulary(twins).word_count(), 1);
  EXPECT_EQ(Vocabulary(twins).WordOf(Descriptor{}), 0);
  EXPECT_EQ(Vocabulary(twins).BranchOf(Descriptor{}), 0);
}

TEST(PlaceIndex, APlaceSeenAgainIsTheMostAlike) {
  SeededRandom random;
  // Thirty places; the last ten show a third of what the first ten do, the rest is new.
  std::vector<std::vector<Descriptor>> places;
  for (int p = 0; p < 30; ++p) {
    places.push_back(Some(150, random));
    for (int i = 0; p >= 20 && i < 50; ++i) {
      places[p][i] = SeenAgain(places[p - 20][i], random);
    }
  }
  std::vector<Descriptor> sample;
  for (const auto& place : places) sample.insert(sample.end(), place.begin(), place.end());
  const Vocabulary vocabulary(sample);
  std::vector<std::vector<int>> words;
  for (const auto& place : places) {
    words.emplace_back();
    for (const auto& d : place) words.back().push_back(vocabulary.WordOf(d));
  }
  const PlaceIndex index(words, vocabulary.word_count());
  for (int p = 20; p < 30; ++p) {
    const std::vector<float> likeness = index.Likeness(p);
    EXPECT_NEAR(likeness[p], 1.0, 1e-4);
    EXPECT_EQ(std::max_element(likeness.begin(), likeness.begin() + 20) - likeness.begin(), p - 20);
  }
}

TEST(PlaceIndex, WordsThatAllPlacesShowSayNothing) {
  const PlaceIndex index({{0, 1}, {0, 2}, {0, 1, 1}, {}}, 3);
  EXPECT_GT(index.Likeness(0)[2], index.Likeness(0)[1]);
  EXPECT_EQ(index.Likeness(0)[3], 0.0F);
  EXPECT_EQ(index.Likeness(3)[0], 0.0F);
}

}  // namespace
}  // namespace rigmap
