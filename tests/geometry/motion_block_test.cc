#include "geometry/motion_block.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

TEST(MotionBlock, IsQuaternionThenTranslationAndComesBack) {
  const Rigid3 motion{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, -0.5, 0.8).normalized())),
      Eigen::Vector3d(1.0, -2.0, 3.5)};
  const MotionBlock block = ToBlock(motion);
  EXPECT_EQ(block[3], motion.rotation.w());
  EXPECT_EQ(block[4], 1.0);
  EXPECT_EQ(block[6], 3.5);
  const Rigid3 back = FromBlock(block.data());
  EXPECT_EQ(back.rotation.coeffs(), motion.rotation.coeffs());
  EXPECT_EQ(back.translation, motion.translation);
}

}  // namespace
}  // namespace rigmap
