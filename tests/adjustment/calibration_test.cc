// What the adjustment says of a wrong calibration.
#include "adjustment/calibration_prior.h"
#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

// A rig that is not what the data were made with.
class CalibrationTest : public AdjustTest {
 protected:
  static constexpr double kTurn_rad = 0.05 * kDegree;

  void SetUp() override {
    Make({.frames = 10, .curve_rad_per_m = 0.2, .points_per_m2 = 12.0, .seed = 81});
    true_rig_ = rover_.rig;
  }

  // Turns the right eye about its own centre.
  void TurnRight(const Eigen::Vector3d& turn_rad) {
    const Rigid3 turn{ExpRotation(turn_rad), Eigen::Vector3d::Zero()};
    rover_.rig.right_from_left = turn * true_rig_.right_from_left;
  }

  void ScaleFocals(double factor) {
    for (RigEye* eye : {&rover_.rig.left, &rover_.rig.right}) {
      eye->camera.fx *= factor;
      eye->camera.fy *= factor;
    }
  }

  static void ExpectWithin(double found, double sigma, double expected) {
    EXPECT_NEAR(found, expected, 3.0 * sigma + 0.2 * std::abs(expected));
  }

  // The turn (right camera axes) that is left from this rig to the true one.
  Eigen::Vector3d TurnLeft_rad(const StereoRig& rig) const {
    return LogRotation(true_rig_.right_from_left.rotation *
                       rig.right_from_left.rotation.conjugate());
  }

  StereoRig true_rig_;
};

TEST_F(CalibrationTest, TheRightRigHasNothingToCorrect) {
  const Adjustment adjusted = Adjust(AllOf(BadOdometry()));
  ASSERT_TRUE(adjusted.calibration);
  const CalibrationStep step = RotationAndFocalStep(*adjusted.calibration).value();
  for (int axis = 0; axis < 3; ++axis) {
    ExpectWithin(step.rig_rotation(axis), step.rig_rotation_sigma(axis), 0.0);
    EXPECT_LT(step.rig_rotation_sigma(axis), 0.1 * kTurn_rad);
  }
  ExpectWithin(step.log_focal, step.log_focal_sigma, 0.0);
  EXPECT_LT(step.log_focal_sigma, 0.002);
  EXPECT_EQ(adjusted.rig.right_from_left.translation, true_rig_.right_from_left.translation);
}

TEST_F(CalibrationTest, ATurnedRightEyeIsFoundByTheStep) {
  for (int axis = 0; axis < 3; ++axis) {
    TurnRight(kTurn_rad * Eigen::Vector3d::Unit(axis));
    const Adjustment adjusted =
        Adjust(AllOf(rover_.world_from_left), {.refine_rig = RigRefinement::kNone});
    ASSERT_TRUE(adjusted.calibration);
    const CalibrationStep step = RotationAndFocalStep(*adjusted.calibration).value();
    for (int i = 0; i < 3; ++i) {
      ExpectWithin(step.rig_rotation(i), step.rig_rotation_sigma(i), i == axis ? -kTurn_rad : 0.0);
    }
    EXPECT_GT(std::abs(step.rig_rotation(axis)), 10.0 * step.rig_rotation_sigma(axis));
    ExpectWithin(step.log_focal, step.log_focal_sigma, 0.0);
  }
}

TEST_F(CalibrationTest, AWrongFocalLengthIsFoundByTheStep) {
  ScaleFocals(1.005);
  const Adjustment adjusted =
      Adjust(AllOf(rover_.world_from_left), {.refine_rig = RigRefinement::kNone});
  const CalibrationStep step = RotationAndFocalStep(adjusted.calibration.value()).value();
  ExpectWithin(step.log_focal, step.log_focal_sigma, -std::log(1.005));
  EXPECT_GT(std::abs(step.log_focal), 3.0 * step.log_focal_sigma);
}

TEST_F(CalibrationTest, ARefinedRigMovesToTheTruthAndKeepsItsBaseline) {
  for (int axis = 0; axis < 3; ++axis) {
    TurnRight(kTurn_rad * Eigen::Vector3d::Unit(axis));
    const MaybePoses poses = AllOf(rover_.world_from_left);
    const Adjustment held = Adjust(poses, {.refine_rig = RigRefinement::kNone}),
                     refined = Adjust(poses, {.refine_rig = RigRefinement::kRotation});
    EXPECT_NEAR(TurnLeft_rad(held.rig).norm(), kTurn_rad, 1e-9);
    EXPECT_LT(TurnLeft_rad(refined.rig).norm(), 0.1 * kTurn_rad);
    const Eigen::Vector3d centre = refined.rig.right_from_left.Inverse().translation;
    EXPECT_LT((centre - true_rig_.right_from_left.Inverse().translation).norm(), 1e-12);  // m
    EXPECT_LT(refined.noise_px, held.noise_px);
  }
}

TEST_F(CalibrationTest, APriorAsSureAsTheImagesMeetsThemHalfway) {
  TurnRight(kTurn_rad * Eigen::Vector3d::UnitX());
  const MaybePoses poses = AllOf(rover_.world_from_left);
  const Adjustment loose =
      Adjust(poses, {.refine_rig = RigRefinement::kRotation, .rig_prior_deg = 10.0});
  const double of_images_deg =
      RotationAndFocalStep(*loose.calibration)->rig_rotation_sigma.x() / kDegree;
  const Adjustment drawn = Adjust(poses, {.refine_rig = RigRefinement::kRotation,
                                          .rig_prior_deg = of_images_deg,
                                          .board_noise_px = 1e-6,
                                          .shared_noise = 1.0});
  // The sigma of the images comes out larger where the rig is not yet right.
  EXPECT_GT(TurnLeft_rad(drawn.rig).norm(), 0.4 * kTurn_rad);
  EXPECT_LT(TurnLeft_rad(drawn.rig).norm(), 0.97 * kTurn_rad);
  const Adjustment held = Adjust(poses, {.refine_rig = RigRefinement::kRotation,
                                         .rig_prior_deg = 0.05 * of_images_deg,
                                         .board_noise_px = 1e-6,
                                         .shared_noise = 1.0});
  EXPECT_GT(TurnLeft_rad(held.rig).norm(), 0.99 * kTurn_rad);
  EXPECT_GT(TurnLeft_rad(held.rig).norm(), TurnLeft_rad(drawn.rig).norm());
}

TEST_F(CalibrationTest, LeftToItselfTheAdjustmentCorrectsOnlyWhatIsWrong) {
  Make({.frames = 30, .curve_rad_per_m = 0.3, .points_per_m2 = 15.0, .seed = 81});
  true_rig_ = rover_.rig;
  const MaybePoses poses = AllOf(rover_.world_from_left);
  const AdjustmentOptions options{.shared_noise = 1.0};  // no observation knows of another's noise
  const Adjustment right = Adjust(poses, options);
  EXPECT_FALSE(right.IsRigCorrected());
  EXPECT_EQ(right.rig.left.camera.fx, true_rig_.left.camera.fx);

  ScaleFocals(1.005);
  TurnRight(kTurn_rad * Eigen::Vector3d(0.5, -0.5, 0.7));
  const Adjustment wrong = Adjust(poses, options);
  EXPECT_TRUE(wrong.IsRigCorrected());
  // A little of a turn may as well be a principal point's.
  EXPECT_LT(TurnLeft_rad(wrong.rig).norm(), 0.25 * kTurn_rad);
  EXPECT_NEAR(wrong.rig.left.camera.fx / true_rig_.left.camera.fx, 1.0, 0.001);
  EXPECT_NEAR(wrong.rig.Baseline(), true_rig_.Baseline(), 1e-12);
  // What was changed is said in sigmas of the prior: half a per cent is one.
  EXPECT_NEAR(wrong.rig_correction_sigmas(kLogFocal), -1.0, 0.2);
  EXPECT_GT(wrong.correction_px, 0.5);
  EXPECT_LT(std::abs(RotationAndFocalStep(*wrong.calibration)->log_focal), 0.0005);
}

// By half a per cent of fx alone, in both eyes.
TEST_F(CalibrationTest, PixelsThatAreNotAsTheFileHasThemAreFound) {
  Make({.frames = 30, .curve_rad_per_m = 0.3, .points_per_m2 = 15.0, .seed = 81});
  true_rig_ = rover_.rig;
  for (RigEye* eye : {&rover_.rig.left, &rover_.rig.right}) eye->camera.fx /= 1.005;
  const Adjustment found = Adjust(AllOf(rover_.world_from_left), {.shared_noise = 1.0});
  EXPECT_TRUE(found.IsRigCorrected());
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    const Camera &is = found.rig.Of(eye).camera, &truth = true_rig_.Of(eye).camera;
    EXPECT_NEAR(is.fy / is.fx / (truth.fy / truth.fx), 1.0, 0.0005);
    EXPECT_NEAR(is.fx / truth.fx, 1.0, 0.001);
  }
}

TEST_F(CalibrationTest, APathShorterThanTheBaselineSaysNothing) {
  for (const double path_m : {0.1, 0.15}) {
    Make({.frames = 6, .step_m = path_m / 5.0, .points_per_m2 = 12.0, .seed = 82});
    const bool is_longer = path_m > rover_.rig.Baseline();
    EXPECT_EQ(Adjust(AllOf(rover_.world_from_left)).calibration.has_value(), is_longer);
  }
}

TEST_F(CalibrationTest, TurnsAloneLeaveTheFocalLength) {
  ScaleFocals(1.005);
  TurnRight(kTurn_rad * Eigen::Vector3d::UnitX());
  const Adjustment turned =
      Adjust(AllOf(rover_.world_from_left), {.refine_rig = RigRefinement::kRotation});
  EXPECT_EQ(turned.rig.left.camera.fx, rover_.rig.left.camera.fx);
  EXPECT_LT(TurnLeft_rad(turned.rig).norm(), 0.3 * kTurn_rad);
}

TEST_F(CalibrationTest, SigmasTakeInWhatTheRigIsNotKnownBy) {
  const MaybePoses poses = AllOf(rover_.world_from_left);
  const Adjustment known = Adjust(poses, {.refine_rig = RigRefinement::kNone,
                                          .rig_prior_deg = 1e-6,
                                          .focal_prior_pct = 1e-6,
                                          .aspect_prior_pct = 1e-6,
                                          .principal_point_prior_px = 1e-6,
                                          .distortion_prior_px = 1e-6});
  TurnRight(kTurn_rad * Eigen::Vector3d::UnitY());
  const Adjustment corrected = Adjust(poses);
  ASSERT_TRUE(corrected.IsRigCorrected());
  const double of_known = known.covariances.back().topLeftCorner<3, 3>().trace();
  const double of_corrected = corrected.covariances.back().topLeftCorner<3, 3>().trace();
  EXPECT_GT(of_corrected, 1.2 * of_known);
}

TEST_F(CalibrationTest, WhatIsNotCorrectedCountsAsWell) {
  const MaybePoses poses = AllOf(rover_.world_from_left);
  const AdjustmentOptions held{.refine_rig = RigRefinement::kNone};
  AdjustmentOptions surer = held;
  surer.rig_prior_deg = surer.focal_prior_pct = surer.aspect_prior_pct =
      surer.principal_point_prior_px = surer.distortion_prior_px = 1e-6;
  const Adjustment doubted = Adjust(poses, held), sure = Adjust(poses, surer);
  const auto variance_m2 = [](const Adjustment& adjustment) {
    return adjustment.covariances.back().topLeftCorner<3, 3>().trace();
  };
  EXPECT_GT(variance_m2(doubted), 1.2 * variance_m2(sure));
  ASSERT_TRUE(doubted.scale_sigma && sure.scale_sigma);
  EXPECT_GT(*doubted.scale_sigma, *sure.scale_sigma);
  // What is left of it where the calibration is known.
  EXPECT_NEAR(*doubted.scale_sigma_of_noise, *sure.scale_sigma, 1e-3 * *sure.scale_sigma);
  EXPECT_NEAR(*sure.scale_sigma_of_noise, *sure.scale_sigma, 1e-3 * *sure.scale_sigma);
  EXPECT_GT(doubted.infinity_offset_sigma_px, 10.0 * sure.infinity_offset_sigma_px);
}

// A path so short that nothing is corrected tells nothing of the rig.
TEST_F(CalibrationTest, NearTheStartThePriorCounts) {
  Make({.frames = 10, .step_m = 0.012, .points_per_m2 = 12.0, .seed = 82});
  const AdjustmentOptions options;
  const Adjustment adjusted = Adjust(AllOf(rover_.world_from_left), options);
  EXPECT_FALSE(adjusted.calibration);
  ASSERT_TRUE(adjusted.scale_sigma && adjusted.scale_sigma_of_noise);
  const double of_rig =
      std::sqrt(std::pow(*adjusted.scale_sigma, 2) - std::pow(*adjusted.scale_sigma_of_noise, 2));
  EXPECT_GT(of_rig, 0.9 * PriorOf(rover_.rig, options).sigmas(kLogFocal));
}

TEST_F(CalibrationTest, StretchesAndRegionsAddUpToTheWhole) {
  TurnRight(kTurn_rad * Eigen::Vector3d::UnitX());
  const Adjustment adjusted =
      Adjust(AllOf(rover_.world_from_left), {.refine_rig = RigRefinement::kNone});
  ASSERT_TRUE(adjusted.calibration);
  const CalibrationEquations& whole = *adjusted.calibration;
  ASSERT_EQ(whole.stretches.size(), 5U);  // of ten frames
  ASSERT_EQ(whole.regions.size(), 8U);
  for (const auto& blocks : {whole.stretches, whole.regions}) {
    CalibrationVector score = CalibrationVector::Zero();
    CalibrationMatrix information = CalibrationMatrix::Zero();
    for (const CalibrationBlock& block : blocks) {
      score += block.score;
      information += block.information;
      EXPECT_GT(block.information.trace(), 0.0);
    }
    EXPECT_LT((score - whole.score).norm(), 1e-6 * whole.score.norm());
    EXPECT_LT((information - whole.information).norm(), 1e-6 * whole.information.norm());
  }
}

// Equations of stretches in which one parameter is off by `off` of its prior sigmas, each stretch
// knowing it to a tenth of the prior; `scatter` is how far the stretches disagree.
CalibrationEquations Stretches(CalibrationParameter parameter, double off,
                               const CalibrationPrior& prior, const std::vector<double>& scatter) {
  CalibrationEquations equations;
  for (const double scattered : scatter) {
    CalibrationBlock block;
    block.information.diagonal() = 100.0 * prior.sigmas.cwiseAbs2().cwiseInverse();
    block.score(parameter) =
        block.information(parameter, parameter) * (off + scattered) * prior.sigmas(parameter);
    equations.score += block.score;
    equations.information += block.information;
    equations.stretches.push_back(block);
  }
  equations.regions = equations.stretches;
  equations.score_covariance = equations.information;
  return equations;
}

TEST(NextRefinement, FreesTheFocalLengthLast) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  const std::vector<double> alike(8, 0.0);
  const auto next = [&](RigRefinement refined, CalibrationParameter parameter, double off,
                        const std::vector<double>& scatter) {
    return NextRefinement(refined, now, Stretches(parameter, off, prior, scatter), prior, options);
  };
  EXPECT_EQ(next(RigRefinement::kNone, kRotationY, 0.0, alike), RigRefinement::kNone);
  EXPECT_EQ(next(RigRefinement::kNone, kRotationY, 2.0, alike), RigRefinement::kAllButFocal);
  EXPECT_EQ(next(RigRefinement::kNone, kLogFocal, 2.0, alike), RigRefinement::kNone);
  EXPECT_EQ(next(RigRefinement::kAllButFocal, kLogFocal, 2.0, alike), RigRefinement::kAll);
  // Stretches that contradict each other do not confirm what they say together.
  const std::vector<double> unlike{9.0, -9.0, 8.0, -8.0, 9.0, -9.0, 8.0, -8.0};
  EXPECT_EQ(next(RigRefinement::kAllButFocal, kLogFocal, 2.0, unlike), RigRefinement::kAllButFocal);
  // Nor do regions of the image that do, while all stretches agree.
  CalibrationEquations dissenting = Stretches(kLogFocal, 2.0, prior, alike);
  dissenting.regions = Stretches(kLogFocal, 2.0, prior, unlike).stretches;
  EXPECT_EQ(NextRefinement(RigRefinement::kAllButFocal, now, dissenting, prior, options),
            RigRefinement::kAllButFocal);
  // For the rest they are not asked.
  dissenting = Stretches(kRotationY, 2.0, prior, alike);
  dissenting.regions = Stretches(kRotationY, 2.0, prior, unlike).stretches;
  EXPECT_EQ(NextRefinement(RigRefinement::kNone, now, dissenting, prior, options),
            RigRefinement::kAllButFocal);
  // What hardly matters is left, however sure.
  EXPECT_EQ(next(RigRefinement::kNone, kRotationY, 0.02, alike), RigRefinement::kNone);
  // Told what to free, it does.
  const AdjustmentOptions told{.refine_rig = RigRefinement::kRotation};
  EXPECT_EQ(NextRefinement(RigRefinement::kNone, now, Stretches(kLogFocal, 0.0, prior, alike),
                           prior, told),
            RigRefinement::kRotation);
}

// One stretch of eight says the opposite, and louder than the others: where that costs half of what
// the focal length would explain, it is not confirmed.
TEST(NextRefinement, AsksForHalfOfWhatAFocalLengthWouldExplain) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  const std::vector<double> one_against{-3.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
  const auto next = [&](double off) {
    return NextRefinement(RigRefinement::kAllButFocal, now,
                          Stretches(kLogFocal, off, prior, one_against), prior, options);
  };
  EXPECT_EQ(next(1.0), RigRefinement::kAllButFocal);
  EXPECT_EQ(next(2.0), RigRefinement::kAll);
}

// Of a short part's six stretches one says the opposite: not of the focal length.
TEST(NextRefinement, OneStretchOfSixMayShowSomethingElse) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const auto next = [&](RigRefinement refined, CalibrationParameter parameter,
                        const std::vector<double>& scatter) {
    return NextRefinement(refined, CalibrationVector::Zero(),
                          Stretches(parameter, 2.0, prior, scatter), prior, options);
  };
  const std::vector<double> one{-3.5, 0.7, 0.7, 0.7, 0.7, 0.7},
      one_of_five{-3.5, 0.9, 0.9, 0.9, 0.9};
  EXPECT_EQ(next(RigRefinement::kNone, kRotationY, one), RigRefinement::kAllButFocal);
  EXPECT_EQ(next(RigRefinement::kNone, kRotationY, one_of_five), RigRefinement::kNone);
  EXPECT_EQ(next(RigRefinement::kAllButFocal, kLogFocal, one), RigRefinement::kAllButFocal);
}

// Blocks, each as sure as the prior, whose estimates of parameters before `ending` lie `times` as
// far apart as their noise would have them, the others' as far.
std::vector<CalibrationBlock> Scattered(int count, int ending, double times,
                                        const CalibrationPrior& prior) {
  std::vector<CalibrationBlock> blocks(count);
  double sign = std::sqrt((count - 1.0) / count);
  for (CalibrationBlock& block : blocks) {
    block.information.diagonal() = prior.sigmas.cwiseAbs2().cwiseInverse();
    for (int i = 0; i < kCalibrationSize; ++i) {
      block.score(i) = (i < ending ? times : 1.0) * sign / prior.sigmas(i);
    }
    sign = -sign;
  }
  return blocks;
}

CalibrationEquations WithBlocks(std::vector<CalibrationBlock> stretches,
                                std::vector<CalibrationBlock> regions) {
  CalibrationEquations equations;
  equations.stretches = std::move(stretches);
  equations.regions = std::move(regions);
  equations.AddUp();
  equations.score_covariance = equations.information;
  return equations;
}

TEST(Inflation, IsUpToThatOfPosesWhereStretchesContradictEachOtherInMost) {
  const AdjustmentOptions options{.shared_noise = 4.0};  // 16 times for poses, six for the rest
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const auto inflation = [&](int ending, double times) {
    const auto agreeing = Scattered(8, 0, 1.0, prior), other = Scattered(8, ending, times, prior);
    const double by_stretches = Inflation(WithBlocks(other, agreeing), options);
    EXPECT_NEAR(Inflation(WithBlocks(agreeing, other), options), by_stretches, 1e-9);
    return by_stretches;
  };
  EXPECT_NEAR(inflation(0, 1.0), 6.0, 1e-9);
  EXPECT_NEAR(inflation(kCalibrationSize, 3.0), 1.5 * 9.0, 1e-9);
  EXPECT_NEAR(inflation(kCalibrationSize, 5.0), 16.0, 1e-9);
  EXPECT_NEAR(inflation(1, 100.0), 6.0, 1e-9) << "a single parameter";
}

TEST(Inflation, IsThatOfPosesWhereStretchesAreTooFewToAgree) {
  const AdjustmentOptions options{.shared_noise = 2.0};
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const auto regions = Scattered(8, 0, 1.0, prior);
  const auto inflation = [&](int stretches) {
    return Inflation(WithBlocks(Scattered(stretches, 0, 1.0, prior), regions), options);
  };
  EXPECT_NEAR(inflation(8), 2.0, 1e-9);
  EXPECT_NEAR(inflation(7), 4.0, 1e-9);
  EXPECT_NEAR(inflation(0), 4.0, 1e-9);
}

TEST(Inflation, CountsWhatTracksDoNotShowOnlyWithSharedNoise) {
  const AdjustmentOptions none{.shared_noise = 1.0}, usual{.shared_noise = 2.0};
  const CalibrationPrior prior = PriorOf(LocCamRig(), none);
  const auto agreeing = Scattered(8, 0, 1.0, prior);
  CalibrationEquations equations = WithBlocks(agreeing, agreeing);
  EXPECT_NEAR(Inflation(equations, usual), 2.0, 1e-9);
  EXPECT_NEAR(InflationOfPoses(equations, usual), 4.0, 1e-9);
  equations.coherent = 5.0;
  EXPECT_NEAR(Inflation(equations, usual), 7.0, 1e-9);
  EXPECT_NEAR(Inflation(equations, none), 1.0, 1e-9);
  equations.score_covariance *= 3.0;
  EXPECT_NEAR(Inflation(equations, usual), 11.0, 1e-9);
  EXPECT_NEAR(InflationOfPoses(equations, usual), 12.0, 1e-9);
}

TEST(MostProbable, FarOutThePriorHardlyPullsAtTheFocalLength) {
  const AdjustmentOptions options{.shared_noise = 1.0};
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  // In sigmas of the prior, by images that are about as sure as it and ask for six of them.
  const auto found = [&](CalibrationParameter parameter) {
    CalibrationEquations equations = Stretches(parameter, 6.0, prior, {0.0});
    for (auto* matrix : {&equations.information, &equations.score_covariance}) *matrix /= 100.0;
    equations.score /= 100.0;
    const CalibrationVector start = CalibrationVector::Zero();
    CalibrationVector now = start;
    for (int i = 0; i < 20; ++i) {
      CalibrationEquations at_now = equations;
      at_now.score -= equations.information * now;
      now = MostProbable(RigRefinement::kAll, now, at_now, prior, options)->correction;
    }
    return now(parameter) / prior.sigmas(parameter);
  };
  EXPECT_GT(found(kLogFocal), 5.2);
  EXPECT_LT(found(kLogFocal), 6.0);
  EXPECT_LT(found(kRightP1), 4.0);
}

TEST(AsGoodAsFound, AFileIsTakenToBeOffByAsMuchInAllAsInWhatIsSeenOfIt) {
  const AdjustmentOptions options{.shared_noise = 1.0};
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationMatrix root = prior.information.inverse().llt().matrixL();
  // Images that tell the first `told` directions of the prior, each to be off by so many sigmas.
  const auto times = [&](int told, double off_sigmas) {
    CalibrationMatrix information = CalibrationMatrix::Zero();
    CalibrationVector correction = CalibrationVector::Zero();
    constexpr double kSure = 1e6;
    for (int i = 0; i < told; ++i) {
      const CalibrationVector direction = root.transpose().inverse().col(i);
      information += kSure * direction * direction.transpose();
      correction += off_sigmas * root.col(i);
    }
    CalibrationEquations equations{.score = information * correction, .information = information};
    equations.score_covariance = information;
    const CalibrationPrior wide =
        AsGoodAsFound(prior, CalibrationVector::Zero(), equations, options);
    EXPECT_TRUE(wide.information.isApprox(prior.information *
                                          std::pow(prior.sigmas(0) / wide.sigmas(0), 2.0)));
    return std::pow(wide.sigmas(kLogFocal) / prior.sigmas(kLogFocal), 2.0);
  };
  EXPECT_NEAR(times(3, 1.0), 1.0, 0.01);
  EXPECT_NEAR(times(3, 2.0), (5.0 + 12.0) / (5.0 + 3.0), 0.01);
  EXPECT_NEAR(times(3, 3.0), (5.0 + 27.0) / (5.0 + 3.0), 0.01);
  EXPECT_NEAR(times(3, 0.5), (5.0 + 0.75) / (5.0 + 3.0), 0.01);
  EXPECT_NEAR(times(12, 0.0), 5.0 / (5.0 + 12.0), 0.03);
  EXPECT_EQ(times(0, 0.0), 1.0);
}

TEST(AsGoodAsFound, AFocalLengthAloneSaysNothingOfTheRest) {
  const AdjustmentOptions options{.shared_noise = 1.0};
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const auto focal_sigma = [&](double off) {
    return AsGoodAsFound(prior, CalibrationVector::Zero(), Stretches(kLogFocal, off, prior, {0.0}),
                         options)
        .sigmas(kLogFocal);
  };
  EXPECT_NEAR(focal_sigma(6.0) / focal_sigma(0.0), 1.0, 1e-6);
}

TEST(NextRefinement, NeedsStretchesToLeaveOut) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  const CalibrationEquations few = Stretches(kRotationY, 2.0, prior, {0.0, 0.0, 0.0});
  EXPECT_FALSE(GainOfRefining(RigRefinement::kNone, RigRefinement::kAll, now, few, few.stretches,
                              prior, options));
  EXPECT_EQ(NextRefinement(RigRefinement::kNone, now, few, prior, options), RigRefinement::kNone);
}

// One region of the image asks for it, the others for none.
TEST(CalibrationError, OfAFocalLengthThatIsContradictedIsWhatWasAskedForAndAtMostThePriors) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  const auto sigma = [&](RigRefinement refined, double asked) {
    CalibrationEquations equations =
        Stretches(kLogFocal, asked, prior, std::vector<double>(8, 0.0));
    std::vector<double> scatter(8, -asked);
    scatter[3] = 7.0 * asked;
    equations.regions = Stretches(kLogFocal, asked, prior, scatter).stretches;
    const CalibrationMatrix error = CalibrationError(refined, now, equations, prior, options);
    return std::sqrt(error(kLogFocal, kLogFocal)) / prior.sigmas(kLogFocal);
  };
  EXPECT_NEAR(sigma(RigRefinement::kAllButFocal, 1.5), 1.0, 1e-6) << "at most the prior's";
  // Where they ask for far more than a rig file is off by, half of that.
  EXPECT_NEAR(sigma(RigRefinement::kAllButFocal, 3.0), 1.5, 0.01);
  // Where it was not asked, how far it is off counts.
  EXPECT_GT(sigma(RigRefinement::kNone, 3.0), 2.5);
  // Sure of little, as a long path is, they are known to little: an error about half of what is
  // asked, as uncertain as that, is within 2.645 times that in 95 of 100.
  EXPECT_NEAR(sigma(RigRefinement::kAllButFocal, 0.4), 2.645 * 0.2 / 1.96, 0.012);
  EXPECT_LT(sigma(RigRefinement::kAllButFocal, 0.0), 0.2);
}

// All regions and stretches ask for the same, only not for enough to follow them.
TEST(CalibrationError, OfAFocalLengthThatNothingContradictsIsAsFarAsItIsAskedFor) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  for (const double asked : {0.1, 0.18, 1.5}) {
    const CalibrationEquations equations =
        Stretches(kLogFocal, asked, prior, std::vector<double>(8, 0.0));
    const CalibrationMatrix error =
        CalibrationError(RigRefinement::kAllButFocal, now, equations, prior, options);
    const auto all = MostProbable(RigRefinement::kAll, now, equations, prior, options);
    ASSERT_TRUE(all);
    const double expected =
        std::hypot(all->correction(kLogFocal), std::sqrt(all->covariance(kLogFocal, kLogFocal)));
    EXPECT_NEAR(std::sqrt(error(kLogFocal, kLogFocal)), expected, 1e-9) << asked;
  }
}

// What only one region tells goes back to the file without it; that is no disagreement.
TEST(CalibrationError, TakesNoPullOfTheFileForDisagreement) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  CalibrationEquations equations = Stretches(kLogFocal, 0.0, prior, std::vector<double>(8, 0.0));
  // One region tells p2 of the right eye, all tell the focal length beside it; the file is three
  // sigmas off in p2, which is corrected.
  CalibrationVector truth = CalibrationVector::Zero();
  truth(kRightP2) = 3.0 * prior.sigmas(kRightP2);
  const auto about = [&](CalibrationBlock& block, double knows_p2) {
    CalibrationMatrix weights = CalibrationMatrix::Zero();
    weights.diagonal() = 100.0 * prior.sigmas.cwiseAbs2().cwiseInverse();
    weights(kRightP2, kRightP2) *= knows_p2;
    weights(kLogFocal, kRightP2) = weights(kRightP2, kLogFocal) =
        0.9 * std::sqrt(knows_p2) * 100.0 / (prior.sigmas(kLogFocal) * prior.sigmas(kRightP2));
    block.information = weights;
  };
  equations.information.setZero();
  for (std::size_t i = 0; i < equations.regions.size(); ++i) {
    about(equations.regions[i], i == 0 ? 1.0 : 0.01);
    equations.information += equations.regions[i].information;
  }
  equations.score_covariance = equations.information;
  const CalibrationVector now = truth;
  for (CalibrationBlock& region : equations.regions) region.score.setZero();
  equations.score.setZero();
  const CalibrationMatrix error =
      CalibrationError(RigRefinement::kAll, now, equations, prior, options);
  const auto all = MostProbable(RigRefinement::kAll, now, equations, prior, options);
  ASSERT_TRUE(all);
  const double off = all->correction(kLogFocal) - now(kLogFocal);
  EXPECT_NEAR(error(kLogFocal, kLogFocal), all->covariance(kLogFocal, kLogFocal) + off * off,
              1e-6 * error(kLogFocal, kLogFocal));
}

// As with a lens that its model does not describe: each region asks for another focal length, all
// stretches for the same.
TEST(CalibrationError, IsWhatRegionsOfTheImageDisagreeBy) {
  const AdjustmentOptions options;
  const CalibrationPrior prior = PriorOf(LocCamRig(), options);
  const CalibrationVector now = CalibrationVector::Zero();
  const std::vector<double> scatter{0.9, -0.9, 0.8, -0.8, 0.9, -0.9, 0.8, -0.8};
  CalibrationEquations equations =
      Stretches(kLogFocal, 0.0, prior, std::vector<double>(scatter.size(), 0.0));
  const auto sigma = [&](CalibrationParameter parameter) {
    const CalibrationMatrix error =
        CalibrationError(RigRefinement::kAll, now, equations, prior, options);
    return std::sqrt(error(parameter, parameter)) / prior.sigmas(parameter);
  };
  const double agreeing = sigma(kLogFocal), rotation = sigma(kRotationY);
  equations.regions = Stretches(kLogFocal, 0.0, prior, scatter).stretches;
  // Standard error of the mean of eight such numbers.
  EXPECT_NEAR(sigma(kLogFocal), 0.91 / std::sqrt(8.0), 0.03);
  EXPECT_LT(agreeing, 0.1);
  EXPECT_EQ(sigma(kRotationY), rotation);
}

TEST(RightPixelAtInfinity, ShiftsWithTheRightEye) {
  StereoRig rig = LocCamRig();
  const StereoRig given = rig;
  EXPECT_EQ(LargestShiftPx(given, rig), 0.0);
  rig.right.camera.cx += 3.0;
  EXPECT_NEAR(DisparityAtInfinity(rig) - DisparityAtInfinity(given), -3.0, 1e-9);
  EXPECT_NEAR(LargestShiftPx(given, rig), 3.0, 1e-9);
  CalibrationVector turn = CalibrationVector::Zero();
  turn(kRotationY) = 0.001;
  EXPECT_NEAR(LargestShiftPx(given, Corrected(given, turn)), 0.001 * given.right.camera.fx,
              1.0);  // more in the corners
}

TEST(LargestShiftSigmas, AreThoseOfThePixelThatIsLeastExpectedToMove) {
  const StereoRig given = LocCamRig();
  CalibrationPrior prior;
  prior.sigmas.setConstant(1e-9);
  prior.sigmas(kRightCx) = 0.5;
  prior.sigmas(kRightK1) = 0.05;
  prior.information = prior.sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
  EXPECT_EQ(LargestShiftSigmas(given, given, prior), 0.0);
  CalibrationVector moved = CalibrationVector::Zero(), bent = moved;
  moved(kRightCx) = 2.0;
  bent(kRightK1) = 0.05;
  // In the middle of the image nothing else moves what is infinitely far.
  EXPECT_NEAR(LargestShiftSigmas(given, Corrected(given, moved), prior), 4.0, 0.01);
  // Ten pixels in the corners, which is what the prior expects there.
  EXPECT_GT(LargestShiftPx(given, Corrected(given, bent)), 10.0);
  EXPECT_LT(LargestShiftSigmas(given, Corrected(given, bent), prior), 1.05);
}

}  // namespace
}  // namespace rigmap
