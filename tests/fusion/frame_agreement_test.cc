#include "fusion/internal/frame_agreement.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/fusion/seen_ground.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr double kStep_m = 0.2;

// Views of one ground along a drive.
class FrameAgreementTest : public testing::Test {
 protected:
  void Make(int frames) {
    for (int i = 0; i < frames; ++i) {
      world_from_left_.push_back(WorldFromLeft(kStep_m * i));
      maps_.push_back(GroundSeenFrom(world_from_left_.back(), {.noise_px = 0.1}, random_));
    }
  }
  // To be called when maps and poses are as the test wants them.
  FrameAgreement Compare() {
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      depths_.push_back({folder_.Path() / std::to_string(i), "key", world_from_left_[i]});
      SaveDepth(depths_.back().path, "key", maps_[i]);
    }
    views_.emplace(depths_, 40);
    return FrameAgreement(world_from_left_, options_, *views_);
  }
  void Brighten(std::size_t frame, double factor) {
    maps_[frame].colour.convertTo(maps_[frame].colour, -1, factor);
  }

  SeededRandom random_;
  TemporaryFolder folder_;
  std::vector<Rigid3> world_from_left_;
  std::vector<DepthMap> maps_;
  std::vector<PosedDepth> depths_;
  std::optional<ViewCache> views_;
  FusionOptions options_;
};

TEST_F(FrameAgreementTest, FramesOfOneGroundAreSound) {
  Make(6);
  FrameAgreement agreement = Compare();
  for (std::size_t i = 0; i < 6; ++i) EXPECT_TRUE(agreement.IsSound(i)) << i;
}

TEST_F(FrameAgreementTest, TheFrameWithAWrongPoseIsNot) {
  Make(6);
  world_from_left_[3].translation.z() += 0.5;
  FrameAgreement agreement = Compare();
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(agreement.IsSound(i), i != 3) << i;
}

TEST_F(FrameAgreementTest, OfTwoFramesNobodyCanTellWhichIsWrong) {
  Make(2);
  world_from_left_[1].translation.z() += 0.5;
  FrameAgreement agreement = Compare();
  EXPECT_TRUE(agreement.IsSound(0));
  EXPECT_TRUE(agreement.IsSound(1));
}

TEST_F(FrameAgreementTest, RemembersWhatItWasAsked) {
  Make(5);
  world_from_left_[2].translation.z() += 0.5;
  FrameAgreement agreement = Compare();
  EXPECT_FALSE(agreement.IsSound(2));
  std::filesystem::remove_all(folder_.Path());
  EXPECT_FALSE(agreement.IsSound(2));
}

TEST_F(FrameAgreementTest, ComparesAsCompareWithDoes) {
  Make(8);
  FrameAgreement agreement = Compare();
  for (std::size_t i = 0; i < 8; ++i) {
    const FrameComparison expected = CompareWith(i, world_from_left_, options_);
    EXPECT_EQ(agreement.ComparisonOf(i).near, expected.near);
    EXPECT_EQ(agreement.ComparisonOf(i).ahead, expected.ahead);
  }
}

// 0.97 of the logarithm is kept.
TEST_F(FrameAgreementTest, AnExposureThatStepsIsTakenBack) {
  Make(4);
  for (const std::size_t i : {2, 3}) Brighten(i, 4.0);
  FrameAgreement agreement = Compare();
  EXPECT_EQ(agreement.BrightnessFor(0), 1.0);
  EXPECT_NEAR(agreement.BrightnessFor(1), 1.0, 1e-9);
  EXPECT_NEAR(agreement.BrightnessFor(2), std::pow(0.25, 0.97), 1e-9);
  // To the mean of frames 0, 1 and 2 as they have become.
  const double mean_log = (2.0 * std::log(0.25) + 0.97 * std::log(0.25)) / 3.0;
  EXPECT_NEAR(agreement.BrightnessFor(3), std::exp(0.97 * mean_log), 1e-9);
}

TEST_F(FrameAgreementTest, AFrameThatSharesNoViewIsSoundAndAsBrightAsItIs) {
  Make(3);
  world_from_left_.push_back(WorldFromLeft(100.0));
  maps_.push_back(GroundSeenFrom(world_from_left_.back(), {.noise_px = 0.1}, random_));
  FrameAgreement agreement = Compare();
  for (std::size_t i = 0; i < 3; ++i) agreement.BrightnessFor(i);
  EXPECT_TRUE(agreement.IsSound(3));
  EXPECT_EQ(agreement.BrightnessFor(3), 1.0);
}

// Each view is darker towards its edge, so that what comes nearer seems to get darker.
TEST_F(FrameAgreementTest, WhatLensesShadeIsNoExposure) {
  Make(30);
  for (DepthMap& map : maps_) {
    for (int row = 0; row < map.colour.rows; ++row) {
      map.colour.row(row).setTo(cv::Scalar::all(200.0 - 0.5 * row));
    }
  }
  FrameAgreement agreement = Compare();
  for (std::size_t i = 0; i < 30; ++i) {
    const double brightness = agreement.BrightnessFor(i);
    if (i >= 10 && i < 29) {  // the last has no view after it
      EXPECT_NEAR(brightness, 1.0, 0.1) << i;
    }
  }
}

TEST_F(FrameAgreementTest, GroundSeenAgainHundredsOfFramesLaterKeepsItsColour) {
  Make(30);
  // Back where frames 12 to 15 were, after a way that the ground was out of view.
  constexpr int kAgain = 4, kElsewhere = 60;
  for (int i = 0; i < kElsewhere; ++i) {
    world_from_left_.push_back(WorldFromLeft(1000.0 + 100.0 * i));
    maps_.push_back(maps_.front());
  }
  for (int i = 0; i < kAgain; ++i) {
    world_from_left_.push_back(world_from_left_[12 + i]);
    maps_.push_back(maps_[12 + i]);
  }
  for (DepthMap& map : maps_) {
    for (int row = 0; row < map.colour.rows; ++row) {
      map.colour.row(row).setTo(cv::Scalar::all(200.0 - 0.5 * row));
    }
  }
  FrameAgreement agreement = Compare();
  double brightness = 0.0;
  for (std::size_t i = 0; i < maps_.size(); ++i) brightness = agreement.BrightnessFor(i);
  EXPECT_NEAR(brightness, 1.0, 0.2);
}

}  // namespace
}  // namespace rigmap
