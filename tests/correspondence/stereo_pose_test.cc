#include "correspondence/stereo_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

const StereoPoseOptions kOptions;

// How the points lie and are measured.
struct Setting {
  int count = 200;
  double noise_px = 0.0;            // of each sighting
  double disparity_noise_px = 0.0;  // of the reference's points
  double reference_noise_px = 0.0;  // of their keypoints
  double nearest_m = 1.0, furthest_m = 6.0;
  double right_share = 0.8;  // of the sightings that the right eye makes too
  bool planar = false;
};

Rigid3 RoverStep(SeededRandom& random) {
  return {random.Rotation(0.1), Eigen::Vector3d(0.05, 0.1, -0.3) + random.Vector(0.1)};
}

Eigen::Vector2d Noisy(const Eigen::Vector3d& x_in_camera, double noise, SeededRandom& random) {
  return x_in_camera.hnormalized() + random.Noise(noise).head<2>();
}

PointSighting Sight(const Rigid3& motion, const StereoRig& rig, const Setting& setting,
                    SeededRandom& random) {
  const double focal = rig.left.camera.MeanFocal();
  Eigen::Vector3d x(random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.3), 1.0);
  x *= setting.planar ? 1.5 / (x.y() + 0.8) : random.Uniform(setting.nearest_m, setting.furthest_m);
  const Eigen::Vector3d moved = motion * x;
  PointSighting sighting;
  sighting.left = Noisy(moved, setting.noise_px / focal, random);
  if (random.Uniform(0.0, 1.0) < setting.right_share) {
    sighting.right = Noisy(rig.right_from_left * moved, setting.noise_px / focal, random);
  }
  // The disparity is measured, the depth what follows from it.
  const double disparity_px = focal * rig.Baseline() / x.z();
  const double measured_px = disparity_px + random.Normal(setting.disparity_noise_px);
  sighting.x_in_reference = x * (disparity_px / std::max(measured_px, 1e-3));
  sighting.x_in_reference.head<2>() +=
      sighting.x_in_reference.z() * random.Noise(setting.reference_noise_px / focal).head<2>();
  const Eigen::Vector3d& found = sighting.x_in_reference;
  sighting.depth_sigma_m =
      found.z() * found.norm() / (focal * rig.Baseline()) * setting.disparity_noise_px;
  return sighting;
}

std::vector<PointSighting> SightAll(const Rigid3& motion, const StereoRig& rig,
                                    const Setting& setting, SeededRandom& random) {
  std::vector<PointSighting> sightings;
  for (int i = 0; i < setting.count; ++i) sightings.push_back(Sight(motion, rig, setting, random));
  return sightings;
}

void MakeWild(PointSighting& sighting, SeededRandom& random) {
  const auto anywhere = [&] {
    return Eigen::Vector2d(random.Uniform(-0.5, 0.5), random.Uniform(-0.4, 0.4));
  };
  sighting.left = anywhere();
  if (sighting.right) sighting.right = anywhere();
}

// Of the left perturbation that leads from `truth` to `found`.
Vector6d Error(const Rigid3& found, const Rigid3& truth) {
  const Rigid3 difference = found * truth.Inverse();
  Vector6d error;
  error << difference.translation, LogRotation(difference.rotation);
  return error;
}

TEST(EstimateStereoPose, IsExactWithoutNoise) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = RoverStep(random);
    const auto sightings = SightAll(truth, rig, {}, random);
    const auto pose = EstimateStereoPose(sightings, rig, {}, kOptions);
    ASSERT_TRUE(pose) << trial;
    EXPECT_LT(Error(pose->current_from_reference, truth).norm(), 1e-8);
    EXPECT_EQ(pose->inlier_count, 200);
  }
}

TEST(EstimateStereoPose, TheInverseMotionOfTheOtherWay) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const Rigid3 truth = RoverStep(random);
  const auto there = SightAll(truth, rig, {}, random);
  std::vector<PointSighting> back;
  for (const auto& sighting : there) {
    const Eigen::Vector3d x = truth * sighting.x_in_reference;
    back.push_back({x, 0.0, sighting.x_in_reference.hnormalized(), std::nullopt});
  }
  const auto a = EstimateStereoPose(there, rig, {}, kOptions);
  const auto b = EstimateStereoPose(back, rig, {}, kOptions);
  ASSERT_TRUE(a && b);
  EXPECT_LT(Error(a->current_from_reference * b->current_from_reference, Rigid3()).norm(), 1e-7);
}

TEST(EstimateStereoPose, WithstandsHalfTheSightingsWild) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = RoverStep(random);
    auto sightings = SightAll(truth, rig, {.noise_px = 0.3, .disparity_noise_px = 0.15}, random);
    for (std::size_t i = 0; i < sightings.size(); i += 2) MakeWild(sightings[i], random);
    const auto pose = EstimateStereoPose(sightings, rig, {}, kOptions);
    ASSERT_TRUE(pose) << trial;
    const Vector6d error = Error(pose->current_from_reference, truth);
    EXPECT_LT(error.head<3>().norm(), 0.02) << "metres, trial " << trial;
    EXPECT_LT(error.tail<3>().norm(), 0.005) << "radians, trial " << trial;
    ASSERT_EQ(pose->inliers.size(), sightings.size());
    int wild = 0, tame = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      (i % 2 == 0 ? wild : tame) += pose->inliers[i] ? 1 : 0;
    }
    EXPECT_EQ(pose->inlier_count, wild + tame);
    EXPECT_GE(tame, 97);
    EXPECT_LE(wild, 4);
  }
}

TEST(EstimateStereoPose, FarPointsDoNotSpoilIt) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const Setting near{.count = 60, .noise_px = 0.3, .disparity_noise_px = 0.15};
  Setting far = near;
  far.count = 300, far.nearest_m = 25.0, far.furthest_m = 120.0;
  double near_square_m2 = 0.0, both_square_m2 = 0.0;
  for (int trial = 0; trial < 40; ++trial) {
    const Rigid3 truth = RoverStep(random);
    auto sightings = SightAll(truth, rig, near, random);
    const auto alone = EstimateStereoPose(sightings, rig, {}, kOptions);
    const auto more = SightAll(truth, rig, far, random);
    sightings.insert(sightings.end(), more.begin(), more.end());
    const auto both = EstimateStereoPose(sightings, rig, {}, kOptions);
    ASSERT_TRUE(alone && both) << trial;
    near_square_m2 += Error(alone->current_from_reference, truth).head<3>().squaredNorm();
    both_square_m2 += Error(both->current_from_reference, truth).head<3>().squaredNorm();
  }
  // They tell the rotation, and thereby help the translation.
  EXPECT_LT(both_square_m2, near_square_m2);
}

// On the horizon: disparities of 0.05 to 0.4 px, of which those that are found are positive.
std::vector<PointSighting> SightHills(const Rigid3& motion, const StereoRig& rig, int count,
                                      SeededRandom& random) {
  auto sightings = SightAll(motion, rig,
                            {.count = count,
                             .noise_px = 0.3,
                             .disparity_noise_px = 0.15,
                             .nearest_m = 250.0,
                             .furthest_m = 2000.0},
                            random);
  std::erase_if(sightings, [](const auto& s) { return s.x_in_reference.z() > 1e4; });
  return sightings;
}

TEST(EstimateStereoPose, HillsAloneTellNoWay) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = RoverStep(random);
    const auto sightings = SightHills(truth, rig, 300, random);
    EXPECT_FALSE(EstimateStereoPose(sightings, rig, std::array{truth, Rigid3()}, kOptions));
  }
}

TEST(EstimateStereoPose, HillsTellTurnsAndDoNotHoldTheRigWhereItWas) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  constexpr int kTrials = 60;
  double squares = 0.0, turn_square_rad2 = 0.0, alone_square_rad2 = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Rigid3 truth = RoverStep(random);
    auto sightings =
        SightAll(truth, rig, {.count = 16, .noise_px = 0.3, .disparity_noise_px = 0.15}, random);
    const auto alone = EstimateStereoPose(sightings, rig, std::array{truth}, {.min_inliers = 10});
    const auto hills = SightHills(truth, rig, 300, random);
    sightings.insert(sightings.end(), hills.begin(), hills.end());
    const auto both = EstimateStereoPose(sightings, rig, std::array{Rigid3()}, kOptions);
    ASSERT_TRUE(alone && both) << trial;
    const Vector6d error = Error(both->current_from_reference, truth);
    const Eigen::Vector3d way = error.head<3>();
    const Eigen::Matrix3d known = both->covariance.topLeftCorner<3, 3>();
    squares += way.dot(known.ldlt().solve(way)) / kTrials;
    turn_square_rad2 += error.tail<3>().squaredNorm();
    alone_square_rad2 += Error(alone->current_from_reference, truth).tail<3>().squaredNorm();
  }
  EXPECT_NEAR(squares, 3.0, 0.4 * 3.0);
  EXPECT_LT(turn_square_rad2, 0.1 * alone_square_rad2);
}

TEST(EstimateStereoPose, MetresOfFarPointsAreUnsure) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const Rigid3 truth = RoverStep(random);
  // Disparities of 0.8 to 1.3 px, known to 0.15.
  const Setting far{
      .noise_px = 0.3, .disparity_noise_px = 0.15, .nearest_m = 80.0, .furthest_m = 120.0};
  auto sightings = SightAll(truth, rig, far, random);
  const auto unsure = EstimateStereoPose(sightings, rig, std::array{truth}, kOptions);
  ASSERT_TRUE(unsure);
  EXPECT_GT(unsure->metres_sigma, 0.1);
  EXPECT_LT(unsure->metres_sigma, 0.25);
  const auto near =
      SightAll(truth, rig, {.count = 12, .noise_px = 0.3, .disparity_noise_px = 0.15}, random);
  sightings.insert(sightings.end(), near.begin(), near.end());
  const auto sure = EstimateStereoPose(sightings, rig, std::array{truth}, kOptions);
  ASSERT_TRUE(sure);
  EXPECT_EQ(sure->metres_sigma, 0.0);
}

double MeanSquaredNormalisedError(const Setting& setting, SeededRandom& random) {
  const StereoRig rig = LocCamRig();
  constexpr int kTrials = 200;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Rigid3 truth = RoverStep(random);
    const auto pose =
        EstimateStereoPose(SightAll(truth, rig, setting, random), rig, std::array{truth}, kOptions);
    if (!pose) throw std::runtime_error("no pose");
    const Vector6d error = Error(pose->current_from_reference, truth);
    sum += error.dot(pose->covariance.ldlt().solve(error)) / kTrials;
  }
  return sum;
}

TEST(EstimateStereoPose, CovarianceIsHonest) {
  SeededRandom random;
  const Setting near{.noise_px = kOptions.noise_px, .disparity_noise_px = 0.15};
  EXPECT_NEAR(MeanSquaredNormalisedError(near, random), 6.0, 0.2 * 6.0);
}

TEST(EstimateStereoPose, CovarianceIsHonestWithoutRightSightings) {
  SeededRandom random;
  const Setting setting{
      .noise_px = kOptions.noise_px, .disparity_noise_px = 0.15, .right_share = 0.0};
  EXPECT_NEAR(MeanSquaredNormalisedError(setting, random), 6.0, 0.2 * 6.0);
}

// Where the reference's keypoints are as noisy as the sightings.
TEST(EstimateStereoPose, NoiseThatBothEyesShareIsCounted) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  StereoPoseOptions options;
  options.reference_noise_px = options.noise_px;
  options.max_sigmas = 2.0;
  const Setting setting{.noise_px = options.noise_px,
                        .disparity_noise_px = 0.15,
                        .reference_noise_px = options.noise_px,
                        .right_share = 1.0};
  constexpr int kTrials = 100;
  double squares = 0.0, inliers = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Rigid3 truth = RoverStep(random);
    const auto pose =
        EstimateStereoPose(SightAll(truth, rig, setting, random), rig, std::array{truth}, options);
    ASSERT_TRUE(pose) << trial;
    const Vector6d error = Error(pose->current_from_reference, truth);
    squares += error.dot(pose->covariance.ldlt().solve(error)) / kTrials;
    inliers += static_cast<double>(pose->inlier_count) / (kTrials * setting.count);
  }
  // Chi-square of the four coordinates, at twice the square of two sigmas.
  EXPECT_NEAR(inliers, 1.0 - std::exp(-4.0) * (1.0 + 4.0), 0.02);
  EXPECT_NEAR(squares, 6.0, 0.3 * 6.0);
}

// As a rig sees it whose disparities are all off by so much, to first order.
void Offset(double offset_px, const StereoRig& rig, PointSighting& sighting) {
  const double focal = rig.left.camera.MeanFocal();
  const double z_m = sighting.x_in_reference.z();
  sighting.x_in_reference *= 1.0 - offset_px * z_m / (focal * rig.Baseline());
  if (sighting.right) {
    *sighting.right += offset_px / focal * rig.right_from_left.translation.head<2>().normalized();
  }
}

TEST(EstimateStereoPose, SaysWhatAnOffsetOfDisparitiesDoes) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  constexpr double kOffset_px = 0.1;
  for (const double nearest_m : {1.0, 3.0}) {
    const Rigid3 truth = RoverStep(random);
    const Setting setting{.count = 400,
                          .noise_px = 0.05,
                          .disparity_noise_px = 0.05,
                          .nearest_m = nearest_m,
                          .furthest_m = 1.5 * nearest_m,
                          .right_share = 1.0};
    auto sightings = SightAll(truth, rig, setting, random);
    const StereoPoseOptions options{.noise_px = 0.05, .max_sigmas = 20.0};
    const auto before = EstimateStereoPose(sightings, rig, std::array{truth}, options);
    for (PointSighting& sighting : sightings) Offset(kOffset_px, rig, sighting);
    const auto after = EstimateStereoPose(sightings, rig, std::array{truth}, options);
    ASSERT_TRUE(before && after);
    const double shortened_m = before->current_from_reference.translation.norm() -
                               after->current_from_reference.translation.norm();
    EXPECT_NEAR(after->offset.lengthening_m_per_px * kOffset_px, shortened_m, 0.1 * shortened_m);
    // Two rays of a point from either frame know it, if not well.
    const double sigma_px = 1.0 / std::sqrt(after->offset.information);
    EXPECT_NEAR(after->offset.score / after->offset.information, kOffset_px, 3.0 * sigma_px);
    EXPECT_NEAR(before->offset.score / before->offset.information, 0.0, 3.0 * sigma_px);
    EXPECT_LT(sigma_px, nearest_m < 2.0 ? 0.05 : 0.5);
  }
}

TEST(EstimateStereoPose, RefusesWhatIsRandom) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int trial = 0; trial < 20; ++trial) {
    auto sightings = SightAll({}, rig, {.count = 150, .disparity_noise_px = 0.15}, random);
    for (auto& sighting : sightings) MakeWild(sighting, random);
    EXPECT_FALSE(EstimateStereoPose(sightings, rig, std::array{Rigid3()}, kOptions)) << trial;
  }
}

TEST(EstimateStereoPose, RefusesTooFewAndNone) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const auto sightings = SightAll(RoverStep(random), rig, {.count = 20}, random);
  EXPECT_FALSE(EstimateStereoPose({}, rig, std::array{Rigid3()}, kOptions));
  EXPECT_TRUE(EstimateStereoPose(sightings, rig, {}, {.min_inliers = 20}));
  EXPECT_FALSE(EstimateStereoPose(sightings, rig, {}, {.min_inliers = 21}));
}

TEST(EstimateStereoPose, RefusesPointsThatAreAllTheSame) {
  const StereoRig rig = LocCamRig();
  const PointSighting one{.x_in_reference = {0.1, 0.2, 3.0}, .left = {0.1 / 3.0, 0.2 / 3.0}};
  const std::vector<PointSighting> same(50, one);
  EXPECT_FALSE(EstimateStereoPose(same, rig, std::array{Rigid3()}, kOptions));
}

TEST(EstimateStereoPose, SameInputSameOutput) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  auto sightings = SightAll(RoverStep(random), rig, {.noise_px = 0.3}, random);
  for (std::size_t i = 0; i < sightings.size(); i += 3) MakeWild(sightings[i], random);
  const auto first = EstimateStereoPose(sightings, rig, {}, kOptions);
  const auto second = EstimateStereoPose(sightings, rig, {}, kOptions);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->current_from_reference.translation, second->current_from_reference.translation);
  EXPECT_EQ(first->current_from_reference.rotation.coeffs(),
            second->current_from_reference.rotation.coeffs());
  EXPECT_EQ(first->covariance, second->covariance);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(EstimateStereoPose, AWildGuessDoesNoHarm) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  const Rigid3 truth = RoverStep(random);
  const auto sightings = SightAll(truth, rig, {}, random);
  const std::array<Rigid3, 2> guesses{Rigid3{random.Rotation(), {0.0, 0.0, -50.0}},
                                      Rigid3{random.Rotation(), random.Vector(10.0)}};
  const auto pose = EstimateStereoPose(sightings, rig, guesses, kOptions);
  ASSERT_TRUE(pose);
  EXPECT_LT(Error(pose->current_from_reference, truth).norm(), 1e-8);
}

TEST(EstimateStereoPose, PlanarPoints) {
  SeededRandom random;
  const StereoRig rig = LocCamRig();
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 truth = RoverStep(random);
    const Setting setting{.noise_px = 0.3, .disparity_noise_px = 0.15, .planar = true};
    const auto pose = EstimateStereoPose(SightAll(truth, rig, setting, random), rig, {}, kOptions);
    ASSERT_TRUE(pose) << trial;
    EXPECT_LT(Error(pose->current_from_reference, truth).head<3>().norm(), 0.02);
    EXPECT_GT(pose->inlier_count, 195);
  }
}

}  // namespace
}  // namespace rigmap
