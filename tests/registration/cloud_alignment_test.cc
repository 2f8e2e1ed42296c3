#include "registration/internal/cloud_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/registration/relief.h"

namespace rigmap {
namespace {

constexpr double kGrid_m = 0.05, kRelief_m = 0.05, kNoise_m = 0.004;

RegistrationOptions By(RegistrationMethod method) {
  RegistrationOptions options;
  options.way = RegistrationWay::kImproved;
  options.method = method;
  return options;
}

const Rigid3 kTarget = WorldFromLeft(0.0), kSource = WorldFromLeft(0.2, 0.03);
const Rigid3 kTargetFromSource = kTarget.Inverse() * kSource;

CloudAlignment AlignSeen(const Rigid3& from, const Rigid3& to, const Rigid3& guess, double relief_m,
                         const RegistrationOptions& options, unsigned seed = 1) {
  return Align(ToPcl(SeenFrom(from, relief_m, kNoise_m, seed)),
               ToPcl(SeenFrom(to, relief_m, kNoise_m, seed + 1000)), guess, kGrid_m, options);
}

Vector6d Difference(const Rigid3& found, const Rigid3& expected) {
  const Rigid3 off = found * expected.Inverse();
  Vector6d difference;
  difference << off.translation, LogRotation(off.rotation);
  return difference;
}

TEST(Align, FindsTheMotionFromAGuessThatIsCentimetresOff) {
  for (const auto method : {RegistrationMethod::kPointToPlane, RegistrationMethod::kGeneralized}) {
    Rigid3 guess = kTargetFromSource;
    guess.translation += Eigen::Vector3d(0.03, -0.01, 0.04);
    const CloudAlignment found = AlignSeen(kSource, kTarget, guess, kRelief_m, By(method));
    EXPECT_TRUE(found.converged) << NameOf(method);
    EXPECT_TRUE(found.held) << NameOf(method);
    EXPECT_GT(found.overlap, 0.7);
    const Vector6d off = Difference(found.target_from_source, kTargetFromSource);
    // PCL's generalised ICP stops earlier on its way.
    const double rest = method == RegistrationMethod::kGeneralized ? 3.0 : 1.0;
    EXPECT_LT(off.head<3>().norm(), 0.005 * rest) << NameOf(method);
    EXPECT_LT(off.tail<3>().norm(), 0.003 * rest) << NameOf(method);
  }
}

TEST(Align, BackwardsFindsTheInverse) {
  const RegistrationOptions options = By(RegistrationMethod::kPointToPlane);
  const Rigid3 there =
      AlignSeen(kSource, kTarget, kTargetFromSource, kRelief_m, options).target_from_source;
  const Rigid3 back =
      AlignSeen(kTarget, kSource, kTargetFromSource.Inverse(), kRelief_m, options, 2)
          .target_from_source;
  EXPECT_LT(Difference(there * back, Rigid3()).head<3>().norm(), 0.006);
}

// As a rig sees them whose disparities are all a little too large or too small.
FrameCloud Farther(FrameCloud cloud, float share_per_m) {
  for (CloudPoint& point : cloud) point.x_in_left *= 1.0F + share_per_m * point.x_in_left.z();
  return cloud;
}

TEST(Align, SaysHowMuchLongerTheWayIsWithDepthsThatAreOff) {
  constexpr float kShare = 0.01F;
  const RegistrationOptions options = By(RegistrationMethod::kPointToPlane);
  const auto align = [&](float share_per_m) {
    return Align(ToPcl(Farther(SeenFrom(kSource, kRelief_m, 0.0, 1), share_per_m)),
                 ToPcl(Farther(SeenFrom(kTarget, kRelief_m, 0.0, 1001), share_per_m)),
                 kTargetFromSource, kGrid_m, options);
  };
  const CloudAlignment nearer = align(-kShare), farther = align(kShare);
  const double longer_m =
      farther.target_from_source.translation.norm() - nearer.target_from_source.translation.norm();
  EXPECT_GT(longer_m, 0.005);
  EXPECT_NEAR(align(0.0F).lengthening_m * 2.0 * kShare, longer_m, 0.2 * longer_m);
}

// Expected of a normalised squared error with six degrees of freedom: 6.
TEST(Align, KnowsHowGoodItIs) {
  constexpr int kTrials = 30;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const CloudAlignment found = AlignSeen(kSource, kTarget, kTargetFromSource, kRelief_m,
                                           By(RegistrationMethod::kPointToPlane), seed);
    ASSERT_TRUE(found.held);
    const Vector6d off = Difference(found.target_from_source, kTargetFromSource);
    squares += off.dot(found.covariance.inverse() * off) / kTrials;
  }
  EXPECT_GT(squares, 2.0);
  EXPECT_LT(squares, 18.0);
}

TEST(Align, IsNotHeldByNoiseOfNormalsOnAPlane) {
  int held_well = 0;
  constexpr int kTrials = 10;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const CloudAlignment found = AlignSeen(kSource, kTarget, kTargetFromSource, 0.0,
                                           By(RegistrationMethod::kPointToPlane), seed);
    // Chance may leave a little; it does not make a sigma below a box.
    const Eigen::Matrix3d position = found.covariance.topLeftCorner<3, 3>();
    if (found.held && std::sqrt(position.trace()) < kGrid_m) ++held_well;
  }
  EXPECT_LE(held_well, 1);
}

TEST(Align, SaysThatCloudsWithoutOverlapHaveNone) {
  const CloudAlignment found = AlignSeen(kSource, kTarget, Rigid3{{1, 0, 0, 0}, {0.0, 0.0, 30.0}},
                                         kRelief_m, By(RegistrationMethod::kPointToPlane));
  EXPECT_LT(found.overlap, 0.05);
}

}  // namespace
}  // namespace rigmap
