#include "gates/gates.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gates/findings.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kStep_m = 0.5;
constexpr double kDepth_m = 3.0;
constexpr double kStepSigma_m = 0.001, kStepSigma_rad = 0.0005;

// A healthy part of twelve keyframes along the left camera's z, every point three metres ahead.
class GatesTest : public testing::Test {
 protected:
  GatesTest() {
    for (int i = 0; i <= 11; ++i) {
      const Rigid3 pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, kStep_m * i}};
      OdometryFrame frame{.stamp_ns = i, .world_from_left = pose, .reference = std::max(0, i - 1)};
      frame.source = PoseSource::kOdometry;
      frame.keyframe = true;
      frame.step_covariance.diagonal() << Eigen::Vector3d::Constant(kStepSigma_m * kStepSigma_m),
          Eigen::Vector3d::Constant(kStepSigma_rad * kStepSigma_rad);
      odometry_.push_back(frame);
      adjustment_.world_from_left.push_back(pose);
      adjustment_.points.push_back(
          {pose * Eigen::Vector3d(0.1, 0.2, kDepth_m), {{.frame = i, .eye = Eye::kLeft}}});
      aligned_.world_from_left.push_back(pose);
      TimedPose& timed = trajectory_.emplace_back();
      timed.stamp_ns = i;
      timed.world_from_left = pose;
      timed.sigmas.setConstant(0.0001);
      timed.position_covariance = 1e-8 * Eigen::Matrix3d::Identity();
      timed.source = PoseSource::kAdjusted;
    }
    adjustment_.reprojection_px = 0.1;
    adjustment_.outlier_share = 0.05;
    Correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1e-6), 0.0, 1e-4);
    aligned_.models.resize(1);
    aligned_.models[0].scale = {1.0, 0.002, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {}};
  }

  // The calibration that the images ask for.
  void Correct(const Eigen::Vector3d& turn, const Eigen::Vector3d& turn_sigma, double log_focal,
               double log_focal_sigma) {
    CalibrationEquations equations;
    equations.information.setIdentity();
    equations.information.diagonal().head<3>() = turn_sigma.cwiseAbs2().cwiseInverse();
    equations.information(3, 3) = 1.0 / (log_focal_sigma * log_focal_sigma);
    equations.score.head<4>() << turn, log_focal;
    equations.score = equations.information * equations.score;
    adjustment_.calibration = equations;
  }

  Gate Judge(const std::string& name) const {
    const Gates gates =
        JudgePart({rig_, odometry_, adjustment_, trajectory_, mapped_ ? &aligned_ : nullptr,
                   rests_on_mapping_, epipolar_px_, depth_consistency_},
                  options_);
    for (const Gate& gate : gates) {
      if (gate.name == name) return gate;
    }
    ADD_FAILURE() << "no gate " << name;
    return {};
  }
  Gates All() const {
    return JudgePart({rig_, odometry_, adjustment_, trajectory_, &aligned_, rests_on_mapping_,
                      epipolar_px_, depth_consistency_},
                     options_);
  }
  // Residuals of a track go together so much that sigmas of the correction are so many times
  // larger.
  void Inflate(double factor) {
    CalibrationEquations& equations = *adjustment_.calibration;
    equations.score_covariance = factor * factor * equations.information;
  }
  // Moves frame `first` by a motion in its own axes, and all behind with it: one step changes.
  void Shift(int first, const Rigid3& motion) {
    const Rigid3 at = *adjustment_.world_from_left[first];
    const Rigid3 moved_from_world = at * motion * at.Inverse();
    for (std::size_t i = first; i < odometry_.size(); ++i) {
      adjustment_.world_from_left[i] = moved_from_world * *adjustment_.world_from_left[i];
    }
  }

  const StereoRig rig_ = LocCamRig();
  GateOptions options_;
  Odometry odometry_;
  Adjustment adjustment_;
  Trajectory trajectory_;
  AlignedKeyframes aligned_;
  bool rests_on_mapping_ = true;
  bool mapped_ = true;
  std::vector<float> epipolar_px_{0.1F, 0.2F, 0.3F};
  std::optional<DepthConsistency> depth_consistency_ = DepthConsistency{};
};

TEST_F(GatesTest, HealthyPartPassesThemAllOnceEach) {
  std::vector<std::string> names;
  for (const Gate& gate : All()) {
    EXPECT_TRUE(gate.passed) << gate.name;
    // The rig was not corrected.
    EXPECT_EQ(gate.value.has_value(), gate.name != "rig_refinement_px") << gate.name;
    names.push_back(gate.name);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre(
                         "baseline_spread", "baseline_rejected", "registered", "predicted",
                         "breaks", "position_95_pct", "scale_95_pct", "rig_refinement_px",
                         "motion_agreement_window", "motion_agreement_sigmas",
                         "motion_agreement_pct", "reprojection_px", "outlier_share", "epipolar_px",
                         "infinity_offset_px", "rig_consistency_deg", "rig_consistency_sigmas",
                         "intrinsics_consistency_pct", "intrinsics_consistency_sigmas",
                         "motion_agreement_drift", "depth_consistency_pct"));
  EXPECT_EQ(FailureReason(All()), "");
}

TEST_F(GatesTest, SpreadIsJudgedAtItsLimitAndByTheWorstModel) {
  aligned_.models[0].scale.relative_spread = options_.mapping.baseline_spread;
  EXPECT_TRUE(Judge("baseline_spread").passed);
  aligned_.models.resize(2);
  aligned_.models[1].scale.relative_spread = options_.mapping.baseline_spread + 1e-9;
  EXPECT_FALSE(Judge("baseline_spread").passed);
  EXPECT_EQ(Judge("baseline_spread").value, options_.mapping.baseline_spread + 1e-9);
}

TEST_F(GatesTest, RejectedShareIsJudgedAtItsLimit) {
  aligned_.models[0].scale.pairs_used = {0, 1, 2, 3};
  aligned_.models[0].scale.pairs_rejected = {4};
  EXPECT_DOUBLE_EQ(*Judge("baseline_rejected").value, 0.2);
  EXPECT_TRUE(Judge("baseline_rejected").passed);
  aligned_.models[0].scale.pairs_rejected = {4, 5};
  EXPECT_FALSE(Judge("baseline_rejected").passed);
}

TEST_F(GatesTest, RegisteredShareIsALowerLimit) {
  options_.mapping.registered = 11.0 / 12.0;
  aligned_.world_from_left[3].reset();
  EXPECT_TRUE(Judge("registered").passed);
  aligned_.world_from_left[4].reset();
  EXPECT_FALSE(Judge("registered").passed);
}

TEST_F(GatesTest, MapOfNoModelHasRegisteredNone) {
  aligned_.models.clear();
  for (auto& pose : aligned_.world_from_left) pose.reset();
  EXPECT_EQ(Judge("registered").value, 0.0);
  EXPECT_FALSE(Judge("registered").passed);
}

TEST_F(GatesTest, PredictedShareCountsFramesThatNothingMeasured) {
  // Of twelve frames two are 0.17, three 0.25; one that was adjusted after all is measured.
  for (const int i : {4, 5, 6, 7}) odometry_[i].source = PoseSource::kPredicted;
  adjustment_.world_from_left[4].reset();
  adjustment_.world_from_left[5].reset();
  EXPECT_TRUE(Judge("predicted").passed);
  adjustment_.world_from_left[6].reset();
  EXPECT_DOUBLE_EQ(*Judge("predicted").value, 0.25);
  EXPECT_FALSE(Judge("predicted").passed);
}

TEST_F(GatesTest, ReprojectionAndOutliersAreJudgedAtTheirLimits) {
  adjustment_.reprojection_px = options_.adjustment.reprojection_px;
  adjustment_.outlier_share = options_.adjustment.outlier_share;
  EXPECT_TRUE(Judge("reprojection_px").passed);
  EXPECT_TRUE(Judge("outlier_share").passed);
  adjustment_.reprojection_px += 1e-9;
  adjustment_.outlier_share += 1e-9;
  EXPECT_FALSE(Judge("reprojection_px").passed);
  EXPECT_FALSE(Judge("outlier_share").passed);
}

TEST_F(GatesTest, EpipolarErrorIsTheMedianOfTheFrames) {
  options_.calibration.epipolar_px = 0.25;
  epipolar_px_ = {0.0F, 0.25F, 9.0F};
  EXPECT_EQ(Judge("epipolar_px").value, 0.25);
  EXPECT_TRUE(Judge("epipolar_px").passed);
  epipolar_px_ = {0.0F, 0.26F, 9.0F};
  EXPECT_FALSE(Judge("epipolar_px").passed);
}

TEST_F(GatesTest, OfACorrectedRigTheEpipolarErrorIsMeasuredAnew) {
  epipolar_px_ = {9.0F};
  adjustment_.rig = rig_;
  adjustment_.rig_correction_sigmas.x() = 1.0;
  const double off_px = 0.5;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d x(0.1 * i - 0.5, 0.2, kDepth_m);
    const auto left = Project(rig_.left.camera, x);
    const auto right = Project(rig_.right.camera, rig_.right_from_left * x);
    ASSERT_TRUE(left && right);
    adjustment_.points[i].observations = {
        {.frame = i, .eye = Eye::kLeft, .pixel = *left},
        {.frame = i, .eye = Eye::kRight, .pixel = *right + Eigen::Vector2d(0.0, off_px)}};
  }
  // Distortion makes a pixel here a little less than one at the centre.
  EXPECT_NEAR(*Judge("epipolar_px").value, off_px, 0.1 * off_px);
  EXPECT_TRUE(Judge("epipolar_px").passed);
}

TEST_F(GatesTest, NotANumberFails) {
  adjustment_.reprojection_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Judge("reprojection_px").passed);
}

TEST_F(GatesTest, OneBadStepInElevenIsForgivenTwoAreNot) {
  // 10 % of the step, 50 sigmas in one of six coordinates.
  const Rigid3 slip{Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}};
  Shift(3, slip);
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
  Shift(7, slip);
  EXPECT_NEAR(*Judge("motion_agreement_pct").value, 10.0, 1e-9);
  EXPECT_NEAR(*Judge("motion_agreement_sigmas").value, 50.0 / std::sqrt(6.0), 1e-9);
  EXPECT_FALSE(Judge("motion_agreement_pct").passed);
  EXPECT_FALSE(Judge("motion_agreement_sigmas").passed);
}

TEST_F(GatesTest, StepsFailOnlyBeyondBothLimits) {
  // Every step slips 1 %: 12 sigmas, but little of the step.
  for (int i = 1; i <= 11; ++i) {
    Shift(i, {Eigen::Quaterniond::Identity(), {6.0 * kStepSigma_m, 0.0, 0.0}});
  }
  options_.adjustment.motion_agreement_sigmas = 2.0;
  EXPECT_GT(*Judge("motion_agreement_sigmas").value, 2.0);
  EXPECT_TRUE(Judge("motion_agreement_sigmas").passed);
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
  options_.adjustment.motion_agreement_pct = 1.0;
  EXPECT_FALSE(Judge("motion_agreement_sigmas").passed);
  EXPECT_FALSE(Judge("motion_agreement_pct").passed);
  options_.adjustment.motion_agreement_sigmas = 3.0;
  EXPECT_TRUE(Judge("motion_agreement_sigmas").passed);
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
}

// Half of the steps are precisely measured and 4 % off, half vaguely and 10 % off: each is within
// one of its limits, though neither kind of difference is for nine steps out of ten.
TEST_F(GatesTest, StepsAreJudgedOneByOne) {
  for (int i = 1; i <= 11; ++i) {
    const bool vague = i % 2 == 0;
    if (vague) odometry_[i].step_covariance *= 1e6;
    Shift(i, {Eigen::Quaterniond::Identity(), {vague ? 0.1 * kStep_m : 0.04 * kStep_m, 0.0, 0.0}});
  }
  options_.adjustment.motion_agreement_sigmas = 1.0;
  EXPECT_TRUE(Judge("motion_agreement_sigmas").passed);
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
}

TEST_F(GatesTest, TurnsCountInSigmas) {
  for (int i = 1; i <= 11; ++i)
    Shift(i, {ExpRotation({0.0, 40 * kStepSigma_rad, 0.0}), Eigen::Vector3d::Zero()});
  EXPECT_NEAR(*Judge("motion_agreement_sigmas").value, 40.0 / std::sqrt(6.0), 1e-6);
  EXPECT_NEAR(*Judge("motion_agreement_pct").value, 0.0, 1e-9);
}

TEST_F(GatesTest, FramesThatWereNotMeasuredSayNothingOfMotion) {
  for (OdometryFrame& frame : odometry_) frame.source = PoseSource::kPredicted;
  EXPECT_FALSE(Judge("motion_agreement_sigmas").value);
  EXPECT_TRUE(Judge("motion_agreement_sigmas").passed);
}

TEST_F(GatesTest, RigTurnIsLimitedByTheDepthErrorItMakes) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  EXPECT_NEAR(Judge("rig_consistency_deg").limit, limit_rad * 180.0 / std::numbers::pi, 1e-12);
  Correct({0.0, 0.999 * limit_rad, 0.0}, Eigen::Vector3d::Constant(1e-6), 0.0, 1e-4);
  EXPECT_EQ(Judge("rig_consistency_sigmas").value, 0.0);
  EXPECT_TRUE(Judge("rig_consistency_deg").passed);
  EXPECT_TRUE(Judge("rig_consistency_sigmas").passed);
  Correct({0.0, limit_rad + 2.1e-6, 0.0}, Eigen::Vector3d::Constant(1e-6), 0.0, 1e-4);
  EXPECT_NEAR(*Judge("rig_consistency_sigmas").value, 2.1, 1e-9);
  EXPECT_FALSE(Judge("rig_consistency_deg").passed);
  EXPECT_FALSE(Judge("rig_consistency_sigmas").passed);
}

TEST_F(GatesTest, DisparityAtInfinityIsLimitedByThatOfTheMedianPoint) {
  const double focal_px = rig_.right.camera.MeanFocal();
  const double median_px = focal_px * rig_.Baseline() / kDepth_m;
  const double limit_px = options_.calibration.max_depth_error_share * median_px;
  EXPECT_NEAR(Judge("infinity_offset_px").limit, limit_px, 1e-12);
  Correct({0.0, 1.5 * limit_px / focal_px, 0.0}, Eigen::Vector3d::Constant(1e-7), 0.0, 1e-4);
  EXPECT_NEAR(*Judge("infinity_offset_px").value, 1.5 * limit_px, 1e-12);
  EXPECT_FALSE(Judge("infinity_offset_px").passed);
  EXPECT_THAT(Judge("infinity_offset_px").why, HasSubstr("by -0."));
  // Rows and roll are another matter.
  Correct({1.5 * limit_px / focal_px, 0.0, 0.0}, Eigen::Vector3d::Constant(1e-7), 0.0, 1e-4);
  EXPECT_TRUE(Judge("infinity_offset_px").passed);
  EXPECT_FALSE(Judge("rig_consistency_deg").passed);
}

// Each axis by itself is within the limit.
TEST_F(GatesTest, TurnsAboutSeveralAxesAddUp) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  Correct(Eigen::Vector3d::Constant(0.9 * limit_rad), Eigen::Vector3d::Constant(1e-6), 0.0, 1e-4);
  EXPECT_TRUE(Judge("infinity_offset_px").passed);
  EXPECT_FALSE(Judge("rig_consistency_deg").passed);
  EXPECT_FALSE(Judge("rig_consistency_sigmas").passed);
}

// Axes that err together are known worse along their sum, and better along their difference, than
// their sigmas by themselves say.
TEST_F(GatesTest, TheSigmaOfATurnKnowsHowItsAxesGoTogether) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  const double sigma_rad = 0.4 * limit_rad;
  const auto turn = [&](double x, double y, double correlation) {
    Correct(limit_rad * Eigen::Vector3d{x, y, 0.0}, Eigen::Vector3d::Constant(sigma_rad), 0.0,
            1e-4);
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Constant(correlation * sigma_rad * sigma_rad);
    covariance.diagonal().setConstant(sigma_rad * sigma_rad);
    CalibrationEquations& equations = *adjustment_.calibration;
    const Eigen::Vector4d step(limit_rad * x, limit_rad * y, 0.0, 0.0);
    equations.information.topLeftCorner<2, 2>() = covariance.inverse();
    equations.score.head<4>() = equations.information.topLeftCorner<4, 4>() * step;
    return *Judge("rig_consistency_sigmas").value;
  };
  const double beyond = std::hypot(0.9, 0.9) - 1.0;
  EXPECT_NEAR(turn(0.9, 0.9, 0.9), beyond / (0.4 * std::sqrt(1.9)), 1e-6);
  EXPECT_NEAR(turn(0.9, -0.9, 0.9), beyond / (0.4 * std::sqrt(0.1)), 1e-6);
}

// Five sigmas of a correction that the images hardly know were once excused.
TEST_F(GatesTest, OnePerCentOfDepthIsNotExcusedByItsSigmas) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  const double one_per_cent_rad = 0.01 * rig_.Baseline() / kDepth_m;
  Correct({0.0, one_per_cent_rad, 0.0}, Eigen::Vector3d::Constant(0.99 * limit_rad), 0.0, 1e-4);
  EXPECT_FALSE(Judge("infinity_offset_px").passed);
  EXPECT_FALSE(Judge("rig_consistency_deg").passed);
  EXPECT_FALSE(Judge("rig_consistency_sigmas").passed);
  const double max_log_focal = options_.calibration.intrinsics_consistency_pct / 100.0;
  Correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1e-6), 0.01, 0.99 * max_log_focal);
  EXPECT_FALSE(Judge("intrinsics_consistency_pct").passed);
  EXPECT_FALSE(Judge("intrinsics_consistency_sigmas").passed);
}

TEST_F(GatesTest, RigTurnBeyondItsLimitWithinItsSigmasIsExcused) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  Correct({0.0, 2.0 * limit_rad, 0.0}, Eigen::Vector3d::Constant(0.51 * limit_rad), 0.0, 1e-4);
  EXPECT_NEAR(*Judge("rig_consistency_sigmas").value, 1.0 / 0.51, 1e-9);
  EXPECT_TRUE(Judge("infinity_offset_px").passed);
  EXPECT_TRUE(Judge("rig_consistency_deg").passed);
  EXPECT_TRUE(Judge("rig_consistency_sigmas").passed);
}

TEST_F(GatesTest, SigmasThatATrackSharesExcuseUpToTheLimit) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  const double max_log_focal = options_.calibration.intrinsics_consistency_pct / 100.0;
  const auto correct = [&] {
    Correct({0.0, 2.5 * limit_rad, 0.0}, Eigen::Vector3d::Constant(0.1 * limit_rad),
            2.5 * max_log_focal, 0.1 * max_log_focal);
  };
  correct();
  EXPECT_NEAR(*Judge("rig_consistency_sigmas").value, 15.0, 1e-9);
  EXPECT_FALSE(Judge("rig_consistency_sigmas").passed);
  Inflate(9.9);
  EXPECT_NEAR(*Judge("rig_consistency_sigmas").value, 15.0 / 9.9, 1e-9);
  EXPECT_NEAR(*Judge("intrinsics_consistency_sigmas").value, 15.0 / 9.9, 1e-9);
  EXPECT_TRUE(Judge("rig_consistency_sigmas").passed);
  // Beyond it residuals go together because the rig is wrong.
  correct();
  Inflate(10.1);
  EXPECT_NEAR(*Judge("rig_consistency_sigmas").value, 15.0, 1e-9);
  EXPECT_NEAR(*Judge("intrinsics_consistency_sigmas").value, 15.0, 1e-9);
  EXPECT_FALSE(Judge("rig_consistency_sigmas").passed);
  EXPECT_FALSE(Judge("intrinsics_consistency_sigmas").passed);
}

TEST_F(GatesTest, RigTurnThatIsHardlyKnownDoesNotApply) {
  const double limit_rad = options_.calibration.max_depth_error_share * rig_.Baseline() / kDepth_m;
  Correct({0.0, 99.0 * limit_rad, 0.0}, {1e-6, 1.001 * limit_rad, 1e-6}, 0.0, 1e-4);
  EXPECT_FALSE(Judge("rig_consistency_deg").value);
  EXPECT_TRUE(Judge("rig_consistency_deg").passed);
  EXPECT_THAT(Judge("rig_consistency_deg").why, HasSubstr("cannot determine"));
  EXPECT_FALSE(Judge("infinity_offset_px").value);
}

TEST_F(GatesTest, FocalCorrectionBeyondItsLimitIsExcusedWithinItsSigmas) {
  Correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1e-6), -0.00221, 1e-4);
  EXPECT_NEAR(*Judge("intrinsics_consistency_pct").value, 0.221, 1e-9);
  EXPECT_NEAR(*Judge("intrinsics_consistency_sigmas").value, 2.1, 1e-9);
  EXPECT_FALSE(Judge("intrinsics_consistency_pct").passed);
  EXPECT_FALSE(Judge("intrinsics_consistency_sigmas").passed);
  Correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1e-6), 0.00219, 1e-4);
  EXPECT_TRUE(Judge("intrinsics_consistency_pct").passed);
  EXPECT_TRUE(Judge("intrinsics_consistency_sigmas").passed);
  Correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(1e-6), 0.009, 0.00205);
  EXPECT_FALSE(Judge("intrinsics_consistency_pct").value);
}

TEST_F(GatesTest, CorrectionsOfTheRigAreJudgedInSigmasOfACalibration) {
  const double limit_px = options_.calibration.rig_refinement_share * rig_.left.camera.width;
  adjustment_.rig_correction_sigmas(1) = 12.0;
  adjustment_.correction_px = limit_px + 0.001;
  EXPECT_NEAR(*Judge("rig_refinement_px").value, limit_px + 0.001, 1e-12);
  EXPECT_FALSE(Judge("rig_refinement_px").passed);
  adjustment_.correction_px = limit_px - 0.001;
  EXPECT_TRUE(Judge("rig_refinement_px").passed);
  // More where the prior expects more; three times that.
  adjustment_.correction_px = 2.0 * limit_px;
  adjustment_.correction_prior_sigmas = 2.9;
  EXPECT_TRUE(Judge("rig_refinement_px").passed);
  adjustment_.correction_prior_sigmas = 3.1;
  EXPECT_FALSE(Judge("rig_refinement_px").passed);
  adjustment_.rig_correction_sigmas.setZero();
  EXPECT_FALSE(Judge("rig_refinement_px").value);
}

TEST_F(GatesTest, ConsistencyOfARigThatWasAskedForWholeIsADiagnostic) {
  Correct({0.01, 0.0, 0.0}, Eigen::Vector3d::Constant(1e-6), 0.01, 1e-4);
  EXPECT_FALSE(Judge("rig_consistency_deg").passed);
  EXPECT_FALSE(Judge("intrinsics_consistency_pct").passed);
  adjustment_.refined = RigRefinement::kRotation;
  EXPECT_FALSE(Judge("intrinsics_consistency_pct").passed);
  adjustment_.refined = RigRefinement::kAllButFocal;
  EXPECT_TRUE(Judge("rig_consistency_deg").passed);
  EXPECT_TRUE(Judge("intrinsics_consistency_pct").passed);
}

TEST_F(GatesTest, ShapeOfAMapThatNothingRestsOnIsADiagnostic) {
  aligned_.models[0].scale.relative_spread = 2.0 * options_.mapping.baseline_spread;
  EXPECT_FALSE(Judge("baseline_spread").passed);
  rests_on_mapping_ = false;
  EXPECT_TRUE(Judge("baseline_spread").passed);
  EXPECT_THAT(Judge("baseline_spread").why, HasSubstr("diagnostic"));
  aligned_.world_from_left.assign(aligned_.world_from_left.size(), std::nullopt);
  EXPECT_TRUE(Judge("registered").passed);
}

TEST_F(GatesTest, ThreeTornStepsOnEndAreNotForgivenAmongMany) {
  // Of 100 steps three are torn: the 90th percentile does not show them.
  while (odometry_.size() < 100) {
    const int i = static_cast<int>(odometry_.size());
    OdometryFrame frame = odometry_.back();
    frame.stamp_ns = i;
    frame.reference = i - 1;
    frame.world_from_left.translation.z() += kStep_m;
    odometry_.push_back(frame);
    adjustment_.world_from_left.push_back(frame.world_from_left);
  }
  const Rigid3 torn{Eigen::Quaterniond::Identity(), {0.1 * kStep_m, 0.0, 0.0}};
  for (const int frame : {40, 41}) Shift(frame, torn);
  EXPECT_TRUE(Judge("motion_agreement_window").passed);
  Shift(42, torn);
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
  EXPECT_FALSE(Judge("motion_agreement_window").passed);
}

TEST_F(GatesTest, OneTornStepIsForgivenToThreeTimesTheLimits) {
  Shift(5, {Eigen::Quaterniond::Identity(), {0.14 * kStep_m, 0.0, 0.0}});
  EXPECT_TRUE(Judge("motion_agreement_window").passed);
  Shift(5, {Eigen::Quaterniond::Identity(), {0.02 * kStep_m, 0.0, 0.0}});
  EXPECT_TRUE(Judge("motion_agreement_pct").passed);
  EXPECT_FALSE(Judge("motion_agreement_window").passed);
}

TEST_F(GatesTest, AccuracyIsJudgedByWhatIsAskedFor) {
  adjustment_.scale_sigma = 0.004;
  EXPECT_NEAR(*Judge("scale_95_pct").value, 0.784, 1e-9);
  EXPECT_TRUE(Judge("scale_95_pct").passed);
  options_.poses.accuracy_pct = 0.5;
  EXPECT_FALSE(Judge("scale_95_pct").passed);
  // Half a decimetre of 5.5 m.
  options_.poses.accuracy_pct = 1.0;
  trajectory_[7].position_covariance.setZero();
  trajectory_[7].position_covariance(0, 0) = 0.05 * 0.05;
  EXPECT_NEAR(*Judge("position_95_pct").value, 100.0 * 1.96 * 0.05 / 5.5, 0.05);
  EXPECT_FALSE(Judge("position_95_pct").passed);
  trajectory_[7].source = PoseSource::kPredicted;  // says itself that it was guessed
  EXPECT_TRUE(Judge("position_95_pct").passed);
}

TEST_F(GatesTest, WhatWasNotDoneDoesNotApplyAndPasses) {
  mapped_ = false;
  epipolar_px_.clear();
  adjustment_.points.clear();
  adjustment_.calibration.reset();
  for (const char* name :
       {"baseline_spread", "baseline_rejected", "registered", "reprojection_px", "outlier_share",
        "rig_refinement_px", "epipolar_px", "infinity_offset_px", "rig_consistency_deg",
        "rig_consistency_sigmas", "intrinsics_consistency_pct", "intrinsics_consistency_sigmas"}) {
    EXPECT_FALSE(Judge(name).value) << name;
    EXPECT_TRUE(Judge(name).passed) << name;
  }
}

// Whichever ring is right, the other's metres are wrong by so much.
TEST_F(GatesTest, NoLengthIsKnownBetterThanDepthsAgree) {
  adjustment_.scale_sigma = 0.0;
  depth_consistency_->radius.depth_pct = {0.3, 0.1};
  depth_consistency_->cells.depth_pct = {0.7, 0.1};  // of far things, which metres do not rest on
  EXPECT_NEAR(*Judge("scale_95_pct").value, 1.96 * 0.3, 1e-9);
  EXPECT_GT(*Judge("position_95_pct").value, 1.9 * 0.3);
}

TEST_F(GatesTest, DepthsMayDifferByTheAccuracyAskedForAndTwoSigmas) {
  depth_consistency_->cells.depth_pct = {1.199, 0.1};
  EXPECT_EQ(Judge("depth_consistency_pct").value, 1.199);
  EXPECT_TRUE(Judge("depth_consistency_pct").passed);
  depth_consistency_->cells.depth_pct = {1.201, 0.1};
  EXPECT_FALSE(Judge("depth_consistency_pct").passed);
  EXPECT_THAT(Judge("depth_consistency_pct").why, HasSubstr("one cell"));
  options_.poses.accuracy_pct = 1.1;
  EXPECT_TRUE(Judge("depth_consistency_pct").passed);
  // Of rings and cells, that which is surer to be large.
  depth_consistency_->radius.depth_pct = {5.0, 3.0};
  EXPECT_EQ(Judge("depth_consistency_pct").value, 1.201);
  depth_consistency_->radius.depth_pct = {5.0, 0.3};
  EXPECT_EQ(Judge("depth_consistency_pct").value, 5.0);
  EXPECT_FALSE(Judge("depth_consistency_pct").passed);
  EXPECT_THAT(Judge("depth_consistency_pct").why, HasSubstr("one ring"));
  depth_consistency_.reset();
  EXPECT_FALSE(Judge("depth_consistency_pct").value);
  EXPECT_TRUE(Judge("depth_consistency_pct").passed);
}

TEST_F(GatesTest, DepthBiasIsJudgedBySize) {
  EXPECT_TRUE(JudgeDepthBias(-options_.dense.depth_bias_px, options_.dense).passed);
  EXPECT_FALSE(JudgeDepthBias(-options_.dense.depth_bias_px - 1e-9, options_.dense).passed);
  EXPECT_FALSE(JudgeDepthBias(options_.dense.depth_bias_px + 1e-9, options_.dense).passed);
  EXPECT_TRUE(JudgeDepthBias(std::nullopt, options_.dense).passed);
}

TEST_F(GatesTest, StepsThatOnlySensorsTellAreFoundAndJoin) {
  const auto findings = [&] {
    return FindingsOf({rig_, odometry_, adjustment_, trajectory_}, options_);
  };
  adjustment_.datum_frames.assign(12, 0);
  odometry_[5].bridged = true;
  EXPECT_THAT(findings().bridged, testing::IsEmpty()) << "tracks join them";
  for (int i = 5; i < 12; ++i) adjustment_.datum_frames[i] = 5;
  EXPECT_THAT(findings().bridged, testing::ElementsAre(5));
  EXPECT_THAT(findings().breaks, testing::IsEmpty());
}

TEST_F(GatesTest, PiecesAreWhatMeasurementsJoin) {
  const auto findings = [&] {
    return FindingsOf(
        {rig_, odometry_, adjustment_, trajectory_, &aligned_, rests_on_mapping_, epipolar_px_},
        options_);
  };
  adjustment_.datum_frames.assign(12, 0);
  EXPECT_THAT(findings().pieces, testing::ElementsAre(FrameRun{0, 12}));
  EXPECT_THAT(findings().guessed, testing::IsEmpty());
  // A frame that shows nothing, but its neighbours were matched with each other.
  odometry_[4].source = trajectory_[4].source = PoseSource::kPredicted;
  odometry_[5].reference = 4;
  EXPECT_THAT(findings().pieces, testing::ElementsAre(FrameRun{0, 12}));
  EXPECT_THAT(findings().guessed, testing::ElementsAre(FrameRun{4, 5}));
  trajectory_[4].position_covariance = 0.04 * Eigen::Matrix3d::Identity();
  EXPECT_NEAR(findings().guessed_95_m, 2.795 * 0.2, 0.01);  // of a chi with three degrees
  EXPECT_EQ(findings().LongestMeasured(), (FrameRun{5, 12}));
  EXPECT_THAT(findings().breaks, testing::IsEmpty());
  EXPECT_TRUE(Judge("breaks").passed);
  // They were not: the odometry began anew, and nothing shows the same points.
  odometry_[5].source = PoseSource::kPredicted;
  std::fill(adjustment_.datum_frames.begin() + 5, adjustment_.datum_frames.end(), 5);
  EXPECT_THAT(findings().pieces, testing::ElementsAre(FrameRun{5, 12}, FrameRun{0, 4}));
  EXPECT_THAT(findings().breaks, testing::ElementsAre(5));
  EXPECT_FALSE(Judge("breaks").passed);
  EXPECT_EQ(Judge("breaks").value, 1.0);
  // The map is torn at frame 10; two frames are no piece.
  Shift(10, {Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}});
  EXPECT_THAT(findings().pieces, testing::ElementsAre(FrameRun{5, 10}, FrameRun{0, 4}));
  EXPECT_THAT(findings().breaks, testing::ElementsAre(5));
}

TEST(FailureReasonText, NamesWhatFailedWithValueLimitAndWhy) {
  const Gates gates{{"a", 0.5, 1.0, true, "of no interest"},
                    {"b", 2.5, 1.0, false, "too much of b"},
                    {"c", std::nullopt, 1.0, true, "does not apply"},
                    {"d", 7.0, 3.0, false, "too much of d"}};
  EXPECT_THAT(FailureReason(gates),
              AllOf(HasSubstr("gate b is 2.5, limit 1: too much of b; "), HasSubstr("gate d"),
                    Not(HasSubstr("interest")), Not(HasSubstr("gate c"))));
  EXPECT_EQ(FailureReason({}), "");
  EXPECT_EQ(FailureReason({{"e", std::nullopt, 1.0, false, "unknown e"}}),
            "gate e is not a number, limit 1: unknown e");
}

}  // namespace
}  // namespace rigmap
