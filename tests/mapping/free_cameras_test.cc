#include "mapping/free_cameras.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::Contains;
using testing::HasSubstr;
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

TEST(MapFreeCameras, AMapperThatDoesNotEndIsEnded) {
  const TemporaryFolder folder;
  const auto program = folder.Write("colmap", "#!/bin/sh\nexec sleep 60\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const FreeCameraPaths paths{folder.Path() / "database.db", folder.Path() / "images",
                              folder.Path() / "scratch", folder.Path() / "log"};
  const MappingResult result =
      MapFreeCameras({.path = program, .version_text = "3.8"}, paths, folder.Path() / "models",
                     {.max_mapping_s = 0.2}, 5, 1);
  EXPECT_TRUE(result.models.empty());
  EXPECT_FALSE(result.method);
  ASSERT_EQ(result.remarks.size(), 1u);
  EXPECT_THAT(result.remarks[0], HasSubstr("COLMAP made no model in 0.2 s (sfm.max_mapping_s)"));
}

}  // namespace
}  // namespace rigmap
