#include "scene/dataset.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TEST(StereoFrame, NamesItsImagesByStampAndLowerCaseExtension) {
  const StereoFrame frame{1234567890123456789, "/data/LEFT 7.PNG", "/data/right.7.Jpeg"};
  EXPECT_EQ(ImageName(frame, Eye::kLeft), "left/1234567890123456789.png");
  EXPECT_EQ(ImageName(frame, Eye::kRight), "right/1234567890123456789.jpeg");
  EXPECT_EQ(frame.PathOf(Eye::kRight), frame.right_path);
}

TEST(DatasetFormat, HasANameInSummaries) {
  EXPECT_EQ(Name(DatasetFormat::kKatwijk), "katwijk");
  EXPECT_EQ(Name(DatasetFormat::kStereoFolder), "stereo");
}

}  // namespace
}  // namespace rigmap
