#include "gates/length_gate.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

constexpr double kBaseline_m = 0.12;

class LengthGate : public testing::Test {
 protected:
  LengthGate() {
    for (int i = 0; i < 12; ++i) {
      const Rigid3 pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.2 * i}};
      poses_.emplace_back(pose);
      odometry_.push_back(
          {.stamp_ns = i, .world_from_left = pose, .source = PoseSource::kOdometry});
    }
  }
  void Stretch(double factor) {
    for (auto& pose : poses_) pose->translation *= factor;
  }
  Gate Judge(double accuracy_pct = 1.0) const {
    return JudgeLength(poses_, odometry_, kBaseline_m, accuracy_pct);
  }

  std::vector<std::optional<Rigid3>> poses_;
  Odometry odometry_;
};

TEST_F(LengthGate, FailsWhereAllStepsAreTooShortAlike) {
  EXPECT_NEAR(*Judge().value, 0.0, 1e-9);
  Stretch(0.8);
  EXPECT_NEAR(*Judge().value, 20.0, 1e-9);
  EXPECT_FALSE(Judge().passed);
  EXPECT_TRUE(Judge(21.0).passed);
}

TEST_F(LengthGate, ComparesWhatBothKnowAlone) {
  Stretch(0.8);
  // Keyframes alone are posed.
  for (std::size_t i = 0; i < poses_.size(); i += 3) poses_[i].reset();
  EXPECT_NEAR(*Judge().value, 20.0, 1e-9);
  // Nothing leads across a guess of the odometry.
  odometry_[5].source = PoseSource::kPredicted;
  for (std::size_t i = 5; i < odometry_.size(); ++i) {
    odometry_[i].world_from_left.translation.x() += 7.0;
  }
  EXPECT_NEAR(*Judge().value, 20.0, 1e-9);
}

TEST_F(LengthGate, JudgesNoWayShorterThanTheBaseline) {
  Stretch(0.8);
  for (OdometryFrame& frame : odometry_) frame.world_from_left.translation *= 0.05;
  EXPECT_FALSE(Judge().value);
  EXPECT_TRUE(Judge().passed);
}

}  // namespace
}  // namespace rigmap
