#include "simulation/rig_errors.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <numbers>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"
#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

StereoRig With(const std::string& spec) { return WithRigErrors(LocCamRig(), std::array{spec}); }

TEST(RigErrors, TurnsKeepTheRightEyesPosition) {
  const StereoRig rig = LocCamRig();
  for (const char axis : {'x', 'y', 'z'}) {
    const StereoRig told = With(std::string("turn-") + axis + "=0.5");
    const Eigen::Vector3d turn =
        LogRotation(told.right_from_left.rotation * rig.right_from_left.rotation.conjugate());
    EXPECT_NEAR(turn[axis - 'x'], 0.5 * std::numbers::pi / 180.0, 1e-9);
    EXPECT_NEAR(turn.norm(), std::abs(turn[axis - 'x']), 1e-9);
    const Eigen::Vector3d moved =
        told.right_from_left.Inverse().translation - rig.right_from_left.Inverse().translation;
    EXPECT_LT(moved.norm(), 1e-12);  // m
  }
}

TEST(RigErrors, EachChangesWhatItSays) {
  const StereoRig rig = LocCamRig();
  EXPECT_DOUBLE_EQ(With("left-cx=1.5").left.camera.cx, rig.left.camera.cx + 1.5);
  EXPECT_DOUBLE_EQ(With("right-cy=-2").right.camera.cy, rig.right.camera.cy - 2.0);
  EXPECT_EQ(With("right-cy=-2").left.camera.cy, rig.left.camera.cy);
  EXPECT_NEAR(With("focal=0.5").right.camera.fy, 1.005 * rig.right.camera.fy, 1e-9);
  EXPECT_NEAR(With("aspect=0.5").left.camera.fx, rig.left.camera.fx / 1.005, 1e-9);
  EXPECT_EQ(With("aspect=0.5").right.camera.fy, rig.right.camera.fy);
  EXPECT_NEAR(With("k1=0.01").left.camera.k1, rig.left.camera.k1 + 0.01, 1e-12);
  EXPECT_NEAR(With("baseline=-1").Baseline(), 0.99 * rig.Baseline(), 1e-12);
}

TEST(RigErrors, DrawsAreThosePriorsExpect) {
  const StereoRig rig = LocCamRig();
  const CalibrationPrior prior = PriorOf(rig, {});
  CalibrationVector squares = CalibrationVector::Zero();
  double over_covariance = 0.0;
  constexpr int kDraws = 600;
  for (int seed = 1; seed <= kDraws; ++seed) {
    const StereoRig told = With(fmt::format("drawn={}", seed));
    EXPECT_NEAR(told.Baseline(), rig.Baseline(), 1e-12);
    const CalibrationVector error = CorrectionBetween(rig, told);
    squares += error.cwiseAbs2();
    over_covariance += error.dot(prior.information * error) / kDraws;
  }
  for (int i = 0; i < kCalibrationSize; ++i) {
    EXPECT_NEAR(std::sqrt(squares(i) / kDraws) / prior.sigmas(i), 1.0, 0.1) << i;
  }
  EXPECT_NEAR(over_covariance, kCalibrationSize, 0.9);
  const CalibrationVector once = CorrectionBetween(rig, With("drawn=7")),
                          twice = CorrectionBetween(rig, With("drawn-double=7"));
  EXPECT_LT((twice - 2.0 * once).norm(), 1e-6 * once.norm());
}

TEST(RigErrors, NonsenseIsRefusedByName) {
  EXPECT_THAT(MessageOf<UsageError>([] { With("warp=1"); }), HasSubstr("turn-x"));
  EXPECT_THAT(MessageOf<UsageError>([] { With("focal"); }), HasSubstr("NAME=VALUE"));
  EXPECT_THAT(MessageOf<UsageError>([] { With("focal=1x"); }), HasSubstr("'1x'"));
  EXPECT_THAT(MessageOf<UsageError>([] { With("focal=nan"); }), HasSubstr("'nan'"));
  for (const char* spec : {"turn-y=400", "focal=-100", "baseline=-150", "k1=1e6", "drawn=-1"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { With(spec); }), HasSubstr("number from")) << spec;
  }
  EXPECT_THAT(MessageOf<UsageError>([] { With("drawn=2.5"); }), HasSubstr("whole number"));
  EXPECT_THAT(DescribeRigErrorNames(), HasSubstr("baseline"));
}

}  // namespace
}  // namespace rigmap
