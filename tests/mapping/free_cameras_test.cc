#include "mapping/free_cameras.h"

#include <gmock/gmock.h>

#include <set>

namespace rigmap {
namespace {

using testing::Contains;
using testing::Not;
using testing::Pair;

std::vector<StereoFrame> Frames(int count) {
  std::vector<StereoFrame> frames;
  for (int i = 0; i < count; ++i) frames.push_back({i, "/a/l.png", "/a/r.png"});
  return frames;
}

TEST(ImagePairs, AreThoseOfNearFramesAndOfDoubledDistances) {
  const auto pairs = ImagePairs(Frames(20), 3);
  EXPECT_THAT(pairs, Contains(Pair("left/0.png", "right/0.png")));
  EXPECT_THAT(pairs, Not(Contains(Pair("right/0.png", "left/0.png"))));
  EXPECT_THAT(pairs, Contains(Pair("right/0.png", "left/3.png")));
  EXPECT_THAT(pairs, Contains(Pair("left/0.png", "left/16.png")));
  EXPECT_THAT(pairs, Not(Contains(Pair("left/0.png", "left/5.png"))));
  EXPECT_THAT(pairs, Not(Contains(Pair("left/0.png", "left/0.png"))));
  EXPECT_EQ(std::set(pairs.begin(), pairs.end()).size(), pairs.size());
  // Four for each pair of frames 1, 2, 3, 4, 8 or 16 apart, one within each frame.
  EXPECT_EQ(pairs.size(), 4U * (19 + 18 + 17 + 16 + 12 + 4) + 20U);
}

}  // namespace
}  // namespace rigmap
