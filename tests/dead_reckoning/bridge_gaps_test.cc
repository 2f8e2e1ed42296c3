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

// An odometry that is right but for four frames, where it carried the motion straight on and began
// anew.
Odometry LostOnTheWay(const DrivenRover& rover, int first_lost = 12) {
  const auto is_lost = [&](int i) { return i >= first_lost && i < first_lost + 4; };
  Odometry odometry = ChainedOdometry(rover, [&](int i) {
    return is_lost(i) ? Rigid3{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1}}
                      : TrueMotion(rover, i);
  });
  for (int i = first_lost; is_lost(i); ++i) odometry[i].source = PoseSource::kPredicted;
  return odometry;
}

std::vector<int> Bridged(const Odometry& odometry) {
  std::vector<int> bridged;
  for (int i = 0; i < std::ssize(odometry); ++i) {
    if (odometry[i].bridged) bridged.push_back(i);
  }
  return bridged;
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
  const Odometry bridged = BridgeGaps(rover_.dataset, lost, WithoutSlip(), {});
  EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
  // 0.8 m without images.
  EXPECT_LT(OffAtEnd(bridged, rover_), 0.04);
  double variance = 0.0;
  for (const int i : Bridged(bridged)) {
    EXPECT_EQ(bridged[i].source, PoseSource::kOdometry);
    variance += bridged[i].step_covariance.topLeftCorner<3, 3>().trace();
  }
  EXPECT_LT(OffAtEnd(bridged, rover_), 4.0 * std::sqrt(variance) + 0.01);
  // What was measured is as it was.
  const Rigid3 before = OdometricStep(lost, 20, 21), after = OdometricStep(bridged, 20, 21);
  EXPECT_LT((before.translation - after.translation).norm(), 1e-12);
}

TEST_F(BridgeGapsTest, WhatWasNotLostStays) {
  Odometry odometry = LostOnTheWay(rover_);
  for (int i = 0; i < kFrames; ++i) {
    odometry[i].source = PoseSource::kOdometry;
    odometry[i].world_from_left = rover_.gauge_from_left[i];
  }
  EXPECT_THAT(Bridged(BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {})), IsEmpty());
}

TEST_F(BridgeGapsTest, FramesHeldFromBothSidesStay) {
  // The frame behind hangs on the one before the gap.
  Odometry odometry = LostOnTheWay(rover_);
  for (int i = 16; i < kFrames; ++i) odometry[i].world_from_left = rover_.gauge_from_left[i];
  odometry[16].reference = 11;
  EXPECT_THAT(Bridged(BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {})), IsEmpty());
}

TEST_F(BridgeGapsTest, WheelsOfAnotherRoverBridgeNothing) {
  DeadReckoningOptions twice = WithoutSlip();
  twice.wheel_radius_m *= 2.0;
  EXPECT_THAT(Bridged(BridgeGaps(rover_.dataset, LostOnTheWay(rover_), twice, {})), IsEmpty());
}

TEST_F(BridgeGapsTest, WithoutSensorsItStaysLost) {
  rover_.dataset.wheels = {{}, "odometry.txt: not there"};
  const Odometry lost = LostOnTheWay(rover_);
  const Odometry bridged = BridgeGaps(rover_.dataset, lost, WithoutSlip(), {});
  EXPECT_THAT(Bridged(bridged), IsEmpty());
  EXPECT_EQ(OffAtEnd(bridged, rover_), OffAtEnd(lost, rover_));
}

TEST_F(BridgeGapsTest, FramesAfterTheLastMeasuredOneAreDrivenTo) {
  Odometry odometry = LostOnTheWay(rover_);
  for (int i = 12; i < kFrames; ++i) odometry[i].source = PoseSource::kPredicted;
  odometry.resize(16);
  rover_.dataset.frames.resize(16);
  const Odometry bridged = BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {});
  EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
  EXPECT_LT(
      (bridged.back().world_from_left.translation - rover_.gauge_from_left[15].translation).norm(),
      0.04);
}

// The images of frame 15 were taken for those of ground that looks the same.
TEST_F(BridgeGapsTest, AMotionThatNothingBearsOutIsTheSensors) {
  Odometry odometry = LostOnTheWay(rover_);
  for (OdometryFrame& frame : odometry) frame.source = PoseSource::kOdometry;
  for (const int i : {12, 13, 14}) odometry[i].source = PoseSource::kPredicted;
  odometry[15].reference = 11;
  const Odometry bridged = BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {});
  EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
  EXPECT_LT(OffAtEnd(bridged, rover_), 0.04);
}

// Frames 12 to 15 saw far hills only, which tell the turn but hardly the way.
TEST_F(BridgeGapsTest, AWayThatImagesHardlyTellIsTheSensors) {
  Odometry odometry = LostOnTheWay(rover_);
  for (const int i : {12, 13, 14, 15}) {
    odometry[i].source = PoseSource::kOdometry;
    odometry[i].step_covariance.diagonal().head<3>().setConstant(0.2 * 0.2);
  }
  const Odometry bridged = BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {});
  EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
  EXPECT_LT(OffAtEnd(bridged, rover_), 0.04);
  EXPECT_GT(OffAtEnd(odometry, rover_), 0.2);
}

TEST_F(BridgeGapsTest, WhatSensorsAgreeOnIsKnownBetter) {
  // Images that scatter against the sensors by what these may err, and by none of it.
  const auto bridged_variance = [&](double scatter_m) {
    Odometry odometry = LostOnTheWay(rover_);
    double sign = 1.0;
    for (int i = 1; i < kFrames; ++i) {
      if (odometry[i].source == PoseSource::kPredicted) continue;
      odometry[i].world_from_left = odometry[i].world_from_left *
                                    Rigid3{Eigen::Quaterniond::Identity(),
                                           {sign * scatter_m, sign * scatter_m, sign * scatter_m}};
      sign = -sign;
    }
    const Odometry bridged = BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {});
    EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
    return bridged[13].step_covariance.topLeftCorner<3, 3>().trace();
  };
  EXPECT_LT(bridged_variance(0.0), 0.3 * bridged_variance(0.005));
}

TEST_F(BridgeGapsTest, WheelsThatSlipMayAsWellWhereNoImageTells) {
  const Odometry lost = LostOnTheWay(rover_);
  Odometry slipping = lost;
  // Two steps of which the wheels turned out half as far again.
  for (const int at : {5, 20}) {
    const Rigid3 step = OdometricStep(lost, at - 1, at);
    const Rigid3 shorter{step.rotation, step.translation / 1.5};
    const Rigid3 move = lost[at - 1].world_from_left * shorter * lost[at].world_from_left.Inverse();
    for (int i = at; i < kFrames; ++i)
      slipping[i].world_from_left = move * slipping[i].world_from_left;
  }
  const auto along = [&](const Odometry& odometry) {
    const Odometry bridged = BridgeGaps(rover_.dataset, odometry, WithoutSlip(), {});
    EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
    return std::sqrt(bridged[13].step_covariance.topLeftCorner<3, 3>().trace());
  };
  // Two of 25 steps: 0.28 of the 0.2 m.
  EXPECT_GT(along(slipping), 0.05);
  EXPECT_LT(along(lost), 0.02);
}

// 16 m out, a turn on the spot, and back: poses near the end are known better than those half way.
TEST(BridgeGaps, KnowsAStepAsWellOnTheWayHomeAsOnTheWayOut) {
  const DrivenRover rover = DriveRover(91, [](double time_s) {
    if (time_s < 40.0 || time_s >= 50.0) return Drive{0.4, 0.0};
    return Drive{0.0, 0.1 * M_PI};
  });
  const auto sigmas = [&](int first_lost) -> Eigen::Vector3d {
    const Odometry bridged =
        BridgeGaps(rover.dataset, LostOnTheWay(rover, first_lost), WithoutSlip(), {});
    EXPECT_TRUE(bridged[first_lost + 1].bridged);
    return bridged[first_lost + 1].step_covariance.diagonal().head<3>().cwiseSqrt();
  };
  const Eigen::Vector3d out = sigmas(34), home = sigmas(56);
  EXPECT_NEAR(home.z() / out.z(), 1.0, 0.1);  // along the way
  EXPECT_NEAR(home.x() / out.x(), 1.0, 0.3);
}

class WheelsInAGap : public testing::TestWithParam<std::function<Drive(double)>> {
 protected:
  // Of the second step of the gap.
  double Sigma_m() const {
    const Odometry bridged = BridgeGaps(rover_.dataset, LostOnTheWay(rover_), WithoutSlip(), {});
    EXPECT_THAT(Bridged(bridged), ElementsAre(12, 13, 14, 15));
    return std::sqrt(bridged[13].step_covariance.topLeftCorner<3, 3>().trace());
  }

  // In the gap wheels turn half as far again, each in its own way.
  void SlipInTheGap() {
    auto& samples = rover_.dataset.wheels.samples;
    std::array<double, 6> more_rad{}, before = samples.front().drive_angle_rad;
    for (WheelSample& sample : samples) {
      const bool is_in_gap = sample.stamp_ns > rover_.dataset.frames[11].stamp_ns &&
                             sample.stamp_ns <= rover_.dataset.frames[15].stamp_ns;
      for (std::size_t k = 0; k < 6; ++k) {
        const double slip = 0.4 + 0.04 * static_cast<double>(k);
        if (is_in_gap) more_rad[k] += slip * (sample.drive_angle_rad[k] - before[k]);
        before[k] = sample.drive_angle_rad[k];
        sample.drive_angle_rad[k] += more_rad[k];
      }
    }
  }

  DrivenRover rover_ = DriveRover(kFrames, GetParam());
};

TEST_P(WheelsInAGap, ThatTurnAsTheirSteeringHasThemDoNotSlip) { EXPECT_LT(Sigma_m(), 0.02); }

TEST_P(WheelsInAGap, ThatTurnUnlikeEachOtherSlip) {
  SlipInTheGap();
  EXPECT_GT(Sigma_m(), 0.2) << "all of the way, which is 0.3 m by the wheels";
}

INSTANTIATE_TEST_SUITE_P(OfEveryWay, WheelsInAGap,
                         testing::Values(
                             [](double) {
                               return Drive{0.2, 0.0};
                             },
                             Curve,
                             [](double time_s) {
                               return Drive{0.2, time_s < 12.5 ? 0.0 : 0.15};
                             },
                             [](double time_s) {
                               return Drive{0.2, time_s < 12.5 ? 0.15 : -0.15};
                             },
                             // A curve that is driven in the gap only.
                             [](double time_s) {
                               return Drive{0.2, time_s > 11.5 && time_s < 14.5 ? 0.1 : 0.0};
                             }));

}  // namespace
}  // namespace rigmap
