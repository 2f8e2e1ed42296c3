// `--use-rtk` beside fixes that are good, and that are spoilt in the ways receivers spoil them.
#include "workflows/stages/satellite_fixes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "geometry/alignment.h"
#include "georeference/local_frame.h"
#include "tests/support/antenna_drive.h"
#include "tests/support/message_of.h"

namespace rigmap {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const Geodetic kKatwijk{52.21, 4.40, 3.0};
constexpr double kClock_s = 0.7;

struct Outcome {
  json report;
  double error_m = 0.0;  // of the antenna, root mean square once laid on the truth
};

class SatelliteFixes : public testing::Test {
 protected:
  SatelliteFixes() {
    const LocalFrame frame(kKatwijk);
    for (const AntennaFix& fix : drive_.Fixes(kClock_s)) {
      const Geodetic at = frame.ToGeodetic(fix.x_in_enu);
      fixes_.push_back({.stamp_ns = static_cast<StampNs>(1e9 * fix.time_s),
                        .status = std::string(kRtkFixed),
                        .latitude_deg = at.latitude_deg,
                        .longitude_deg = at.longitude_deg,
                        .altitude_m = at.altitude_m,
                        .sigma_enu_m = fix.sigma_m});
    }
  }

  // Fixes between two times, moved by so much to the east.
  void Move(double from_s, double to_s, double east_m) {
    const LocalFrame frame(kKatwijk);
    for (GnssFix& fix : fixes_) {
      const double time_s = 1e-9 * static_cast<double>(fix.stamp_ns);
      if (time_s < from_s || time_s > to_s) continue;
      Eigen::Vector3d enu = frame.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
      enu.x() += east_m;
      const Geodetic moved = frame.ToGeodetic(enu);
      fix.latitude_deg = moved.latitude_deg;
      fix.longitude_deg = moved.longitude_deg;
    }
  }

  Outcome Tie(const Eigen::Vector3d& antenna = kAntenna, double max_clock_offset_s = 3.0) const {
    Dataset dataset;
    dataset.rig.antenna_in_left = antenna;
    dataset.rig.right_from_left.translation.x() = -0.12;
    AdjustedPart part{.trajectory = drive_.images};
    part.adjustment.world_from_left.resize(drive_.images.size());
    part.adjustment.scale_sigma = AntennaDrive::kScaleSigma;
    JoinedParts parts{.parts = {{.name = "1.1"}}};
    parts.first_part.resize(drive_.images.size(), 0);
    const TiedPart tied = TieToFixes().make({}, dataset, part, parts, SplitByTurns(fixes_),
                                            {.max_clock_offset_s = max_clock_offset_s});
    return {json::parse(tied.report), Error(tied.part.trajectory)};
  }
  double ErrorOfImages() const { return Error(drive_.images); }

  AntennaDrive drive_;
  std::vector<GnssFix> fixes_;

 private:
  // A heading and a shift are nobody's fault: the best ones are taken.
  double Error(const Trajectory& poses) const {
    std::vector<Eigen::Vector3d> found, in_truth;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      found.push_back(poses[i].world_from_left * kAntenna);
      in_truth.push_back(drive_.truth[i].world_from_left * kAntenna);
    }
    const Sim3 motion = AlignPoints(found, in_truth, false);
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      sum += (motion * found[i] - in_truth[i]).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(found.size()));
  }
};

TEST_F(SatelliteFixes, ClockAndLeverArmCount) {
  const Outcome good = Tie();
  ASSERT_TRUE(good.report["used"]) << good.report.dump();
  EXPECT_NEAR(good.report["clock_offset_s"].get<double>(), kClock_s, 0.03);
  ASSERT_EQ(good.report["clocks"].size(), 1U);
  EXPECT_FALSE(good.report["clocks"][0]["weak"]);
  EXPECT_LT(good.error_m, 0.3 * ErrorOfImages());
  // Where one of them is not corrected, and no judge objects, the path is worse.
  const Outcome no_clock = Tie(kAntenna, 1e-3), no_arm = Tie(Eigen::Vector3d::Zero());
  std::cout << "images " << ErrorOfImages() << " m, tied " << good.error_m << " m, without clock "
            << no_clock.error_m << " m, without lever arm " << no_arm.error_m << " m\n";
  EXPECT_GT(no_clock.error_m, 2.0 * good.error_m);
  EXPECT_GT(no_arm.error_m, 2.0 * good.error_m);
}

TEST_F(SatelliteFixes, AJumpIsLeftOut) {
  const double good_m = Tie().error_m;
  Move(60.0, 69.0, 5.0);  // of a turn that ties
  const Outcome outcome = Tie();
  ASSERT_TRUE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_GE(outcome.report["not_believed"].get<int>(), 4);
  const json& spans = outcome.report["not_believed_spans"];
  ASSERT_EQ(spans.size(), 1U) << spans.dump();
  EXPECT_EQ(spans[0]["count"], outcome.report["not_believed"]);
  EXPECT_NEAR(1e-9 * spans[0]["first_ns"].get<double>(), 60.0, 3.0);
  EXPECT_NEAR(1e-9 * spans[0]["last_ns"].get<double>(), 69.0, 3.0);
  EXPECT_TRUE(outcome.report["gaps"].empty());
  EXPECT_LT(outcome.error_m, 2.0 * good_m);
}

TEST_F(SatelliteFixes, TwoMetresOverTwentyAreNotBelieved) {
  const double good_m = Tie().error_m;
  Move(60.0, 160.0, 2.0);  // half of the way, so that hardly a majority is right
  const Outcome outcome = Tie();
  if (outcome.report["used"]) {
    EXPECT_GE(outcome.report["not_believed"].get<int>(), 20);
    EXPECT_LT(outcome.error_m, 2.0 * good_m);
  } else {
    EXPECT_NEAR(outcome.error_m, ErrorOfImages(), 1e-9);
  }
}

TEST_F(SatelliteFixes, AGapIsBridgedByTheImages) {
  const double good_m = Tie().error_m;
  std::erase_if(fixes_, [](const GnssFix& fix) {
    return fix.stamp_ns > 70'000'000'000 && fix.stamp_ns < 130'000'000'000;
  });
  const Outcome outcome = Tie();
  ASSERT_TRUE(outcome.report["used"]) << outcome.report.dump();
  const json& gaps = outcome.report["gaps"];
  ASSERT_EQ(gaps.size(), 1U) << gaps.dump();
  EXPECT_LE(gaps[0]["first_ns"], 70'000'000'000);
  EXPECT_GE(gaps[0]["last_ns"], 130'000'000'000);
  EXPECT_LT(outcome.error_m, 3.0 * good_m);
}

TEST_F(SatelliteFixes, FloatIsCountedAndLeftOut) {
  const double good_m = Tie().error_m;
  Move(0.0, 50.0, 0.6);
  int spoilt = 0;
  for (GnssFix& fix : fixes_) {
    if (fix.stamp_ns > 50'000'000'000) continue;
    fix.status = "RTK_FLOAT";
    ++spoilt;
  }
  ASSERT_GT(spoilt, 20);
  const Outcome outcome = Tie();
  ASSERT_TRUE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_GT(outcome.report["not_rtk_fixed"].get<int>(), spoilt / 3);
  EXPECT_EQ(outcome.report["not_believed"], 0);
  EXPECT_LT(outcome.error_m, 3.0 * good_m);
}

// One every twenty seconds: all of them would lie in even turns.
TEST_F(SatelliteFixes, OfFewFixesEveryOtherOneJudges) {
  std::erase_if(fixes_, [](const GnssFix& fix) { return fix.stamp_ns % 20'000'000'000 != 0; });
  ASSERT_GE(fixes_.size(), 9U);
  const SplitFixes split = SplitByTurns(fixes_);
  EXPECT_GE(split.tying.size(), 4U);
  EXPECT_GE(split.judging.size(), 4U);
  const Outcome outcome = Tie();
  // Fewer than forty do not tell the clock of a part.
  ASSERT_EQ(outcome.report["clocks"].size(), 1U);
  EXPECT_TRUE(outcome.report["clocks"][0]["weak"]);
  if (outcome.report["used"]) {
    EXPECT_LT(outcome.report["judging_rms_after_m"], outcome.report["judging_rms_before_m"]);
  } else {
    EXPECT_NEAR(outcome.error_m, ErrorOfImages(), 1e-9);
  }
}

// The first frames were black: their poses are guesses, and the path begins behind them.
TEST_F(SatelliteFixes, GuessesBeforeThePathHoldNothing) {
  constexpr int kGuessed = 4;
  const Outcome plain = Tie();
  for (int i = 0; i < kGuessed; ++i) {
    drive_.images[i].source = PoseSource::kPredicted;
    drive_.images[i].world_from_left.translation += Eigen::Vector3d(0.5, 0.4, 0.1);
    drive_.images[i].position_covariance = 0.4 * Eigen::Matrix3d::Identity();
    drive_.images[i].sigmas << Eigen::Vector3d::Constant(0.63), Eigen::Vector3d::Constant(0.1);
  }
  const Outcome outcome = Tie();
  ASSERT_TRUE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_LE(outcome.report["not_believed"].get<int>(), 1) << "the one beside a guess";
  EXPECT_NEAR(outcome.report["scale_correction_pct"].get<double>(),
              plain.report["scale_correction_pct"].get<double>(), 0.03);
  EXPECT_LT(outcome.report["judging_rms_after_m"].get<double>(),
            1.1 * plain.report["judging_rms_after_m"].get<double>());
}

// Those that tie are drawn aside where the others are not: most of the way would be better, the
// rest ruined.
TEST_F(SatelliteFixes, ARuinedStretchIsNotLeftOutOfTheJudgement) {
  const LocalFrame frame(kKatwijk);
  for (GnssFix& fix : fixes_) {
    const double time_s = 1e-9 * static_cast<double>(fix.stamp_ns);
    if (time_s < 140.0 || fix.stamp_ns / 10'000'000'000 % 2 == 1) continue;
    Eigen::Vector3d enu = frame.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
    enu.x() += 0.02 * (time_s - 140.0);  // a metre at the end
    const Geodetic moved = frame.ToGeodetic(enu);
    fix.latitude_deg = moved.latitude_deg;
    fix.longitude_deg = moved.longitude_deg;
    fix.sigma_enu_m.setConstant(0.05);
  }
  const Outcome outcome = Tie();
  EXPECT_LT(outcome.error_m, 1.01 * ErrorOfImages());
}

TEST_F(SatelliteFixes, AreNotUsedWhereNoneIsLeftToJudge) {
  // Those that judge are no fixes.
  for (GnssFix& fix : fixes_) {
    if (fix.stamp_ns / 10'000'000'000 % 2 == 1) fix.status = "RTK_FLOAT";
  }
  const Outcome outcome = Tie();
  EXPECT_FALSE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_THAT(outcome.report["why_not"].get<std::string>(), HasSubstr("of the fixes held back"));
  EXPECT_NEAR(outcome.error_m, ErrorOfImages(), 1e-9);
}

TEST_F(SatelliteFixes, SwappedColumnsAreNotUsed) {
  for (GnssFix& fix : fixes_) std::swap(fix.latitude_deg, fix.longitude_deg);
  const Outcome outcome = Tie();
  EXPECT_FALSE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_THAT(outcome.report["why_not"].get<std::string>(),
              HasSubstr("once latitude and longitude are exchanged"));
  EXPECT_NEAR(outcome.error_m, ErrorOfImages(), 1e-9);
}

TEST_F(SatelliteFixes, OthersThatDoNotFitAreNotCalledExchanged) {
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    fixes_[i].latitude_deg = kKatwijk.latitude_deg + 1e-4 * std::sin(static_cast<double>(i * i));
  }
  const Outcome outcome = Tie();
  EXPECT_FALSE(outcome.report["used"]) << outcome.report.dump();
  EXPECT_THAT(outcome.report["why_not"].get<std::string>(), Not(HasSubstr("exchanged")));
}

TEST_F(SatelliteFixes, SigmasThatAreTooSmallAreTold) {
  const Outcome good = Tie();
  EXPECT_TRUE(good.report["consistent"]) << good.report.dump();
  EXPECT_TRUE(good.report["remark"].is_null());
  for (std::size_t i = 0; i < fixes_.size(); ++i) {
    fixes_[i].latitude_deg += (i % 2 == 0 ? 1.5 : -1.5) * 1e-7;  // 17 mm, stated as 5 mm
  }
  const Outcome outcome = Tie();
  EXPECT_FALSE(outcome.report["consistent"]) << outcome.report.dump();
  EXPECT_GT(outcome.report["chi2_per_degree_as_stated"], outcome.report["chi2_per_degree_limit"]);
  EXPECT_THAT(outcome.report["remark"].get<std::string>(), HasSubstr("contradict each other"));
}

TEST_F(SatelliteFixes, AreAskedForWithAnAntenna) {
  const auto tie = [&](const Dataset& dataset, const SplitFixes& fixes) {
    TieToFixes().make({}, dataset, {}, {}, fixes, {});
  };
  Dataset dataset;
  dataset.rig.source = "calib.yaml";
  EXPECT_THAT(MessageOf<DataError>([&] { tie(dataset, SplitByTurns(fixes_)); }),
              HasSubstr("calib.yaml: --use-rtk: expected the antenna's place"));
  dataset.rig.antenna_in_left = kAntenna;
  EXPECT_THAT(MessageOf<DataError>([&] { tie(dataset, {}); }),
              HasSubstr("expected satellite fixes beside the images, found none"));
}

}  // namespace
}  // namespace rigmap
