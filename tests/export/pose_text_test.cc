#include "export/pose_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(FormatPose, ReadsBack) {
  SeededRandom random;
  for (int i = 0; i < 50; ++i) {
    const Rigid3 pose = random.Motion(1000.0);
    std::istringstream text(FormatPose(pose, ' '));
    Eigen::Vector3d t;
    Eigen::Vector4d q;
    text >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
    ASSERT_TRUE(text);
    EXPECT_LT((t - pose.translation).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_GE(q.w(), 0.0);
    const double sign = pose.rotation.w() < 0.0 ? -1.0 : 1.0;
    EXPECT_LT((sign * q - pose.rotation.coeffs()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(FormatPose, SaysTheSameOfAQuaternionAndItsNegative) {
  SeededRandom random;
  const Rigid3 pose = random.Motion(3.0);
  Rigid3 negative = pose;
  negative.rotation.coeffs() = -negative.rotation.coeffs();
  EXPECT_EQ(FormatPose(pose, ' '), FormatPose(negative, ' '));
}

TEST(FormatPose, SeparatesSevenNumbers) {
  const std::string text = FormatPose({}, ',');
  EXPECT_EQ(std::ranges::count(text, ','), 6);
  EXPECT_EQ(text.find(' '), std::string::npos);
}

}  // namespace
}  // namespace rigmap
