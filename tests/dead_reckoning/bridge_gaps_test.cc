#include "dead_reckoning/bridge_gaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/dead_reckoning/driven_rover.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kFrames = 30;

Drive Curve(double) { return {0.2, 0.15}; }

// An odometry that is right but for frames 12 to 15, where it carried the motion straight on and
// began anew.
Odometry LostOnTheWay(const DrivenRover& rover) {
  Odometry odometry;
  for (int i = 0; i < kFrames; ++i) {
    OdometryFrame frame{.stamp_ns = rover.dataset.frames[i].stamp_ns,
                        .reference = std::max(0, i - 1),
                        .source = PoseSource::kOdometry,
                        .keyframe = true};
    frame.step_covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, 1e-8;
    if (i > 0) {
      const bool is_lost = i >= 12 && i < 16;
      const Rigid3 step = is_lost
                              ? Rigid3{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1}}
                              : rover.gauge_from_left[i - 1].Inverse() * rover.gauge_from_left[i];
      frame.world_from_left = odometry[i - 1].world_from_left * step;
      if (is_lost) frame.source = PoseSource::kPredicted;
    }
    odometry.push_back(frame);
  }
  return odometry;
}

double OffAtEnd(const Odometry& odometry, const DrivenRover& rover) {
  return (odometry.back().world_from_left.translation -
          rover.gauge_from_left[kFrames - 1].translation)
      .norm();
}

class BridgeGapsTest : public testing::Test {
 protected:
  DrivenRover rover_ = DriveRover(kFrames, Curve);
};

TEST_F(BridgeGapsTest, WheelsAndGyroTellTheWayThatNoImageShows) {
  const Odometry lost = LostOnTheWay(rover_);
  ASSERT_GT(OffAtEnd(lost, rover_), 0.3);
  const BridgedOdometry bridged = BridgeGaps(rover_.dataset, lost, WithoutSlip(), {});
  EXPECT_THAT(bridged.bridged, ElementsAre(12, 13, 14, 15));
  // 0.8 m without images.
  EXPECT_LT(OffAtEnd(bridged.odometry, rover_), 0.04);
  double variance = 0.0;
  for (const int i : bridged.bridged) {
    EXPECT_EQ(bridged.odometry[i].source, PoseSource::kOdometry);
    variance += bridged.odometry[i].step_covariance.topLeftCorner<3, 3>().trace();
  }
  EXPECT_LT(OffAtEnd(bridged.odometry, rover_), 4.0 * std::sqrt(variance) + 0.01);
  // What was measured is as it was.
  const Rigid3 before = OdometricStep(lost, 20, 21),
               after = OdometricStep(bridged.odometry, 20, 21);
  EXPECT_LT((before.translation - after.translation).norm(), 1e-12);
}

TEST_F(BridgeGapsTest, WhatWasNotLostStays) {
  Odometry odometry = LostOnTheWay(rover_);
  for (OdometryFrame& frame : odometry) frame.source = PoseSource::kOdometry;
  EXPECT_THAT(BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {}).bridged, IsEmpty());
}

TEST_F(BridgeGapsTest, FramesHeldFromBothSidesStay) {
  // The frame behind hangs on the one before the gap.
  Odometry odometry = LostOnTheWay(rover_);
  odometry[16].reference = 11;
  EXPECT_THAT(BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {}).bridged, IsEmpty());
}

TEST_F(BridgeGapsTest, WheelsOfAnotherRoverBridgeNothing) {
  DeadReckoningOptions twice = WithoutSlip();
  twice.wheel_radius_m *= 2.0;
  EXPECT_THAT(BridgeGaps(rover_.dataset, LostOnTheWay(rover_), twice, {}).bridged, IsEmpty());
}

TEST_F(BridgeGapsTest, WithoutSensorsItStaysLost) {
  rover_.dataset.wheels = {{}, "odometry.txt: not there"};
  const Odometry lost = LostOnTheWay(rover_);
  const BridgedOdometry bridged = BridgeGaps(rover_.dataset, lost, WithoutSlip(), {});
  EXPECT_THAT(bridged.bridged, IsEmpty());
  EXPECT_EQ(OffAtEnd(bridged.odometry, rover_), OffAtEnd(lost, rover_));
}

}  // namespace
}  // namespace rigmap
