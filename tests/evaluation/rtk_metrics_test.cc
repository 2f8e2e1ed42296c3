#include "evaluation/rtk_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using Pairs = std::vector<FixPair>;

const Eigen::Vector3d kSigma_m(0.004, 0.005, 0.009);

RtkAlignment Alignment() {
  RtkAlignment alignment;
  alignment.plane_from_world = {0.7, {20.0, -3.0}};
  return alignment;
}

// An S of fixes 0.6 m apart, above which the antenna was laid: estimate times `scale`, rising by
// `climb` of the way, with noise of the fixes as stated.
Pairs Drive(int count, double scale, double climb, SeededRandom& random) {
  Pairs pairs;
  Eigen::Vector2d at(0.0, 0.0);
  double along_m = 0.0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d in_plane = Alignment().plane_from_world * at;
    Eigen::Vector3d fix(in_plane.x(), in_plane.y(), 6.0 + 0.02 * std::sin(0.2 * i));
    Eigen::Vector3d antenna(scale * at.x(), scale * at.y(), fix.z() - 4.0 + climb * along_m);
    const Eigen::Vector3d noise = kSigma_m.cwiseProduct(random.Noise(1.0));
    pairs.push_back({antenna, fix + noise, kSigma_m});
    const double heading_rad = std::sin(0.1 * i);
    at += 0.6 * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
    along_m += 0.6;
  }
  return pairs;
}

TEST(CompareRtk, FindsNoMoreThanTheNoiseOfTheFixesInATruePath) {
  SeededRandom random;
  const auto metrics = CompareRtk(Drive(200, 1.0, 0.0, random), Alignment());
  ASSERT_TRUE(metrics && metrics->scale);
  EXPECT_EQ(metrics->fixes, 200);
  EXPECT_NEAR(metrics->path_m, 199 * 0.6, 0.01 * 199 * 0.6);
  EXPECT_NEAR(metrics->horizontal_rms_m.noise, std::hypot(0.004, 0.005), 1e-4);
  EXPECT_NEAR(metrics->horizontal_rms_m.value / metrics->horizontal_rms_m.noise, 1.0, 0.15);
  EXPECT_NEAR(metrics->height_rms_m.value / metrics->height_rms_m.noise, 1.0, 0.2);
  // Of normal noise: Rayleigh's 2.146 sigmas (of both axes alike, about), and 1.645.
  EXPECT_NEAR(metrics->ce90_m / (2.146 * std::hypot(0.004, 0.005) / std::sqrt(2.0)), 1.0, 0.15);
  EXPECT_NEAR(metrics->le90_m / (1.645 * 0.009), 1.0, 0.2);
  EXPECT_LT(std::abs(metrics->scale->value - 1.0), 4.0 * metrics->scale->noise);
  EXPECT_LT(std::abs(metrics->height_drift_pct), 4.0 * metrics->height_drift_noise_pct);
  ASSERT_EQ(metrics->drift.size(), 5U);
  for (const RtkDrift& drift : metrics->drift) {
    EXPECT_NEAR(drift.horizontal_pct.value / drift.horizontal_pct.noise, 1.0, 0.35);
    EXPECT_NEAR(drift.height_pct.value / drift.height_pct.noise, 1.0, 0.35);
  }
  // Over twice the way noise counts half.
  EXPECT_NEAR(metrics->drift[0].horizontal_pct.noise / metrics->drift[1].horizontal_pct.noise, 2.0,
              0.3);
}

TEST(CompareRtk, TellsAWrongScaleAndADriftOfTheHeight) {
  SeededRandom random;
  const auto metrics = CompareRtk(Drive(100, 1.0 / 1.01, 0.02, random), Alignment());
  ASSERT_TRUE(metrics && metrics->scale);
  EXPECT_NEAR(metrics->scale->value, 1.01, 4.0 * metrics->scale->noise);
  EXPECT_LT(metrics->scale->noise, 1e-4);
  EXPECT_NEAR(metrics->height_drift_pct, 2.0, 0.05);
  EXPECT_GT(metrics->height_rms_m.value, 10.0 * metrics->height_rms_m.noise);
  EXPECT_NEAR(metrics->drift.back().horizontal_pct.value, 1.0, 0.3);
  EXPECT_NEAR(metrics->drift.back().height_pct.value, 2.0, 0.1);
}

TEST(CompareRtk, SaysWhatItCanOfAShortPathAndNothingOfFewFixes) {
  SeededRandom random;
  const auto short_path = CompareRtk(Drive(6, 1.0, 0.0, random), Alignment());
  ASSERT_TRUE(short_path);
  EXPECT_TRUE(short_path->drift.empty());
  EXPECT_FALSE(ToJson(*short_path).contains("drift"));
  EXPECT_FALSE(CompareRtk(Drive(3, 1.0, 0.0, random), Alignment()));
  EXPECT_FALSE(CompareRtk({}, Alignment()));
  Pairs still(8, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), kSigma_m});
  const auto metrics = CompareRtk(still, Alignment());
  ASSERT_TRUE(metrics);
  EXPECT_FALSE(metrics->scale);
  EXPECT_FALSE(ToJson(*metrics).contains("rms_pct"));
}

TEST(CompareRtk, PutsTheNoiseBesideEachFigure) {
  SeededRandom random;
  const auto json = ToJson(*CompareRtk(Drive(40, 1.0, 0.0, random), Alignment()));
  for (const auto& [figure, noise] :
       {std::pair("rms_pct", "noise_pct"), std::pair("height_rms_m", "height_noise_m"),
        std::pair("height_drift_pct", "height_drift_noise_pct"),
        std::pair("scale", "scale_noise")}) {
    EXPECT_TRUE(json.contains(figure) && json.contains(noise)) << json;
    EXPECT_GT(json[noise], 0.0);
  }
  EXPECT_GT(json["ce90_m"], 0.0);
  EXPECT_GT(json["le90_m"], 0.0);
  ASSERT_EQ(json["drift"].size(), 2U);
  EXPECT_EQ(json["drift"][1]["segment_m"], 10.0);
  EXPECT_GT(json["drift"][1]["height_noise_pct"], 0.0);
}

}  // namespace
}  // namespace rigmap
