#include "georeference/earth_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "georeference/internal/height_fit.h"
#include "tests/georeference/rover_drive.h"

namespace rigmap {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Driven {
  Trajectory trajectory;
  std::vector<GnssFix> fixes;
};

// A drive whose world lies so on the Earth, its fixes every `every_s`; `lean_rad`: what the world's
// up is off by, about x.
Driven Drive(const EarthFrame& truth, const Steering& steering, double duration_s, double every_s,
             SeededRandom& random, double lean_rad = 0.0) {
  const RoverDrive drive(steering, duration_s);
  Driven driven{drive.Poses(0.0, random), {}};
  const LocalFrame plane(truth.origin);
  const StampNs first_ns = driven.trajectory.front().stamp_ns;
  const Eigen::AngleAxisd lean(lean_rad, Eigen::Vector3d::UnitX());
  for (double time_s = 0.5; time_s < duration_s; time_s += every_s) {
    GnssFix fix;
    fix.stamp_ns = first_ns + static_cast<StampNs>(std::llround(1e9 * time_s));
    fix.status = kRtkFixed;
    fix.sigma_enu_m = {0.005, 0.005, 0.009};
    const Eigen::Vector3d antenna = lean * (drive.WorldFromLeft(time_s) * kAntennaInLeft);
    const Geodetic position = plane.ToGeodetic(truth.EnuFromWorld(antenna) +
                                               random.Noise(1.0).cwiseProduct(fix.sigma_enu_m));
    fix.latitude_deg = position.latitude_deg;
    fix.longitude_deg = position.longitude_deg;
    fix.altitude_m = position.altitude_m;
    driven.fixes.push_back(fix);
  }
  return driven;
}

EarthFrame RandomTruth(SeededRandom& random) {
  const Geodetic origin{random.Uniform(-75.0, 80.0), random.Uniform(-179.0, 179.0),
                        random.Uniform(0.0, 3000.0)};
  return {origin, random.Uniform(-3.0, 3.0), random.Vector(20.0), UtmZoneOf(origin)};
}

TEST(EarthFit, FindsPositionHeightAndHeadingAnywhereOnEarthWithinItsSigmas) {
  SeededRandom random;
  double height_square = 0.0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    const EarthFrame truth = RandomTruth(random);
    const Driven driven = Drive(truth, SCurve(), 60.0, 3.0, random);
    const EarthFit fit = FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {});
    ASSERT_TRUE(fit.frame) << fit.why;
    EXPECT_EQ(fit.frame->zone, truth.zone);
    EXPECT_GE(fit.heights, 18);
    const LocalFrame plane(truth.origin);
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(12, 3, -1)}) {
      const Eigen::Vector3d off =
          plane.ToEnu(EarthMap(*fit.frame).ToGeodetic(x)) - truth.EnuFromWorld(x);
      EXPECT_LT(off.head<2>().norm(), 6.0 * fit.horizontal->SigmaAt(x.head<2>()) + 0.002);
      EXPECT_LT(std::abs(off.z()), 4.0 * fit.height_sigma_m + 1e-4);  // m
      height_square += std::pow(off.z() / fit.height_sigma_m, 2.0) / (2 * kRuns);
    }
  }
  EXPECT_GT(height_square, 0.4);
  EXPECT_LT(height_square, 2.0);
}

TEST(EarthFit, FixesThatFitOnlyExchangedGiveNoEarthFrame) {
  SeededRandom random;
  const Geodetic origin{52.2, 4.4, 3.0};
  Driven driven =
      Drive({origin, 0.4, {2.0, 3.0, 1.0}, UtmZoneOf(origin)}, SCurve(), 60.0, 3.0, random);
  EXPECT_TRUE(FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {}).frame);
  for (GnssFix& fix : driven.fixes) std::swap(fix.latitude_deg, fix.longitude_deg);
  const EarthFit fit = FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {});
  EXPECT_FALSE(fit.frame);
  EXPECT_THAT(fit.why, HasSubstr("once latitude and longitude are exchanged"));
}

TEST(EarthFit, AStraightDriveLeavesTheRollOpenAndSaysSo) {
  SeededRandom random;
  const Driven straight = Drive(RandomTruth(random), Straight(), 60.0, 3.0, random);
  const EarthFit open = FitToEarth(straight.fixes, straight.trajectory, kAntennaInLeft, {});
  ASSERT_TRUE(open.frame) << open.why;
  EXPECT_THAT(open.weaknesses, Contains(HasSubstr("leave the roll about the path open")));
  EXPECT_THAT(open.weaknesses, Not(Contains(HasSubstr("pitch"))));
  EXPECT_THAT(open.weaknesses, Contains(HasSubstr("clock offset")));
  const Driven circle = Drive(RandomTruth(random), SCurve(), 120.0, 1.0, random);
  const EarthFit closed = FitToEarth(circle.fixes, circle.trajectory, kAntennaInLeft, {});
  EXPECT_THAT(closed.weaknesses, testing::IsEmpty());
}

TEST(EarthFit, FewFixesAreUsedAndCalledSo) {
  SeededRandom random;
  const Driven driven = Drive(RandomTruth(random), SCurve(), 10.0, 3.0, random);
  const EarthFit fit = FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {});
  ASSERT_TRUE(fit.frame) << fit.why;
  EXPECT_THAT(fit.weaknesses, Contains(HasSubstr("fixes agree with the path")));
  EXPECT_GT(fit.edge_sigma_m, 0.005);  // m
}

TEST(EarthFit, AnUpThatTheFixesContradictIsNamed) {
  SeededRandom random;
  constexpr double kLean_rad = 0.03;
  const Driven driven = Drive(RandomTruth(random), Circle(), 60.0, 1.0, random, kLean_rad);
  const EarthFit fit = FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {});
  ASSERT_TRUE(fit.frame) << fit.why;
  ASSERT_TRUE(fit.along_path && fit.across_path);
  EXPECT_NEAR(std::hypot(fit.along_path->angle_rad, fit.across_path->angle_rad), kLean_rad, 0.005);
  EXPECT_THAT(fit.weaknesses, Contains(HasSubstr("contradict the world's up")));
}

TEST(EarthFit, WithoutFixesItSaysWhy) {
  SeededRandom random;
  const Driven driven = Drive(RandomTruth(random), SCurve(), 20.0, 3.0, random);
  const EarthFit none = FitToEarth({}, driven.trajectory, kAntennaInLeft, {});
  EXPECT_FALSE(none.frame);
  EXPECT_THAT(none.why, HasSubstr("expected RTK fixes"));
  EXPECT_TRUE(ToJson(none)["epsg"].is_null());
  std::vector<GnssFix> floating = driven.fixes;
  for (GnssFix& fix : floating) fix.status = "RTK_FLOAT";
  EXPECT_FALSE(FitToEarth(floating, driven.trajectory, kAntennaInLeft, {}).frame);
}

TEST(EarthFit, JsonStatesTransformsThatAgreeWithTheFrame) {
  SeededRandom random;
  const Driven driven = Drive(RandomTruth(random), SCurve(), 60.0, 3.0, random);
  const EarthFit fit = FitToEarth(driven.fixes, driven.trajectory, kAntennaInLeft, {});
  ASSERT_TRUE(fit.frame);
  const auto json = ToJson(fit);
  EXPECT_EQ(json["epsg"], fit.frame->zone.Epsg());
  const Eigen::Vector3d x(2.0, -1.0, 0.5);
  const auto applied = [&](const char* name) {
    Eigen::Vector3d result;
    for (int i = 0; i < 3; ++i) {
      const auto row = json[name][i].get<std::vector<double>>();
      result(i) = row[0] * x.x() + row[1] * x.y() + row[2] * x.z() + row[3];
    }
    return result;
  };
  EXPECT_LT((applied("enu_from_world") - fit.frame->EnuFromWorld(x)).norm(), 1e-9);
  EXPECT_LT((applied("utm_from_world") - EarthMap(*fit.frame).ToGrid(x)).norm(), 1e-4);  // m
  EXPECT_GT(json["sigma"]["horizontal_m"], 0.0);
  EXPECT_LT(json["sigma"]["height_m"], 0.01);
}

// Uphill is uphill the way that was driven, and the left side is the left of it.
TEST(HeightFit, TellsTiltsAlongTheWayDrivenAndToItsLeft) {
  constexpr double kAlong = 0.01, kToLeft = 0.02;
  for (const double heading : {0.3, 2.0, 3.4, 5.0}) {
    const Eigen::Rotation2Dd turn(heading);
    std::vector<HeightPair> pairs;
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector2d driven(0.5 * i, std::sin(0.3 * i));  // ahead, to the left
      pairs.push_back({turn * driven, kAlong * driven.x() + kToLeft * driven.y(), 0.001});
    }
    const HeightFit fit = FitHeight(pairs);
    ASSERT_TRUE(fit.along && fit.across);
    EXPECT_NEAR(fit.along->angle_rad, kAlong, 0.001) << heading;
    EXPECT_NEAR(fit.across->angle_rad, kToLeft, 0.001) << heading;
  }
}

// Each height much like the one before, as a receiver's are.
TEST(HeightFit, HeightsThatWanderAreKnownLess) {
  constexpr int kTrials = 300, kFixes = 80;
  constexpr double kAlike = 0.8, kSigma_m = 0.01;
  SeededRandom random;
  double squares = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<HeightPair> pairs;
    double off_m = random.Normal(kSigma_m);
    for (int i = 0; i < kFixes; ++i) {
      off_m = kAlike * off_m + random.Normal(kSigma_m * std::sqrt(1.0 - kAlike * kAlike));
      pairs.push_back({{0.5 * i, 0.0}, off_m, kSigma_m});
    }
    const HeightFit fit = FitHeight(pairs);
    squares += std::pow(fit.rise_m / fit.sigma_m, 2.0) / kTrials;
  }
  EXPECT_LT(std::sqrt(squares), 1.4);  // 2.9 if each counts by itself
}

TEST(HeightFit, LeavesOutWhatIsFarOff) {
  SeededRandom random;
  std::vector<HeightPair> pairs;
  for (int i = 0; i < 20; ++i) {
    pairs.push_back({{i, 0.1 * i * i}, 5.0 + random.Normal(0.01), 0.01});
  }
  pairs[7].rise_m += 2.0;
  const HeightFit fit = FitHeight(pairs);
  EXPECT_EQ(fit.used.size(), 19U);
  EXPECT_NEAR(fit.rise_m, 5.0, 0.01);
  EXPECT_NEAR(fit.sigma_m, 0.01 / std::sqrt(19.0), 0.001);
}

}  // namespace
}  // namespace rigmap
