#include "fusion/depth_fusion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "tests/fusion/seen_ground.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class FuseDepthMapsOfGround : public testing::Test {
 protected:
  // With half a pixel's noise the small camera is less certain than a point may be by default.
  void SetUp() override { options_.max_sigma_pct = 100.0; }

  void Drive(int frames, const GroundView& view) {
    for (int i = 0; i < frames; ++i) AddView(0.17 * i + 0.01 * random_.Uniform(0.0, 1.0), view);
    Store();
  }
  void AddView(double x_m, const GroundView& view) {
    const Rigid3 world_from_left = WorldFromLeft(x_m);
    depths_.push_back({folder_.Path() / std::to_string(maps_.size()), "key", world_from_left});
    maps_.push_back(GroundSeenFrom(world_from_left, view, random_));
  }
  void Store() {
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      SaveDepth(depths_[i].path, depths_[i].key, maps_[i]);
    }
  }

  // Sets left_out_, too.
  PointCloud Fuse(std::span<const PosedDepth> depths) {
    PointCloud cloud;
    const FusionTarget target{folder_.Path() / "scratch",
                              [&cloud](std::span<const SurfacePoint> piece) {
                                cloud.insert(cloud.end(), piece.begin(), piece.end());
                              }};
    left_out_ = FuseDepthMaps(depths, voxel_m_, options_, target);
    return cloud;
  }
  PointCloud Fuse() { return Fuse(depths_); }

  double HighestM() {
    double highest_m = 0.0;
    for (const SurfacePoint& point : Fuse()) {
      highest_m = std::max(highest_m, static_cast<double>(point.x_in_world.z()));
    }
    return highest_m;
  }

  SeededRandom random_;
  TemporaryFolder folder_;
  std::vector<DepthMap> maps_;
  std::vector<PosedDepth> depths_;
  double voxel_m_ = 0.01;
  FusionOptions options_;
  std::vector<std::size_t> left_out_;
};

double RmsHeightM(const PointCloud& cloud) {
  double sum = 0.0;
  for (const SurfacePoint& point : cloud) sum += std::pow(point.x_in_world.z(), 2);
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

// Of the points in the middle of the way, which frames pass from far to near.
double WorstSigmaM(const PointCloud& cloud) {
  double worst_m = 0.0;
  for (const SurfacePoint& point : cloud) {
    const auto& x = point.x_in_world;
    if (x.x() < 1.5F || x.x() > 2.5F || std::abs(x.y()) > 0.5F) continue;
    worst_m = std::max(worst_m, static_cast<double>(point.sigma_m));
  }
  return worst_m;
}

// Squares of 10 cm of the ground that hold points.
std::set<std::pair<long, long>> CoveredSquares(const PointCloud& cloud) {
  std::set<std::pair<long, long>> covered;
  for (const SurfacePoint& point : cloud) {
    covered.emplace(std::lround(10.0F * point.x_in_world.x()),
                    std::lround(10.0F * point.x_in_world.y()));
  }
  return covered;
}

// What the nearest frames have passed a further one behind has seen.
TEST_F(FuseDepthMapsOfGround, KeepsWhatOnlyAFurtherFrameConfirms) {
  for (const double x_m : {0.0, 1.2, 1.3, -1.4}) AddView(x_m, {});
  Store();
  options_.neighbours = 2;
  const std::set<std::pair<long, long>> covered = CoveredSquares(Fuse());
  for (long x_dm = 10; x_dm <= 18; ++x_dm) EXPECT_TRUE(covered.contains({x_dm, 0})) << x_dm;
}

TEST_F(FuseDepthMapsOfGround, GivesOneThinLayer) {
  Drive(2, {});
  const PointCloud cloud = Fuse();
  ASSERT_GT(cloud.size(), 5000U);
  std::size_t without_normal = 0;  // in the corners of the images
  for (const SurfacePoint& point : cloud) {
    // Disparities are stored in steps of 1/64 px: 4 mm of depth at 4 m, seen at 16 degrees.
    ASSERT_NEAR(point.x_in_world.z(), 0.0, 0.005);
    if (point.normal.isZero()) {
      ++without_normal;
    } else {
      ASSERT_GT(point.normal.z(), 0.99F);
      ASSERT_NEAR(point.normal.norm(), 1.0F, 1e-5F);
    }
    ASSERT_EQ(point.rgb, (std::array<std::uint8_t, 3>{10, 20, 30}));
  }
  EXPECT_LT(without_normal, cloud.size() / 100);
}

TEST_F(FuseDepthMapsOfGround, MergesWhatIsSeenAgain) {
  voxel_m_ = 0.2;  // all of it is known to three of these
  Drive(1, {});
  options_.min_views = 1;
  depths_.push_back(depths_[0]);
  const PointCloud twice = Fuse();
  depths_.push_back(depths_[0]);
  const PointCloud thrice = Fuse();
  EXPECT_GE(thrice.size(), twice.size());  // more observations: more voxels have enough
  options_.min_observations = 1;
  EXPECT_EQ(Fuse().size(), Fuse(std::span(depths_).first(2)).size());
}

// Nobody confirms it, and nothing is averaged.
TEST_F(FuseDepthMapsOfGround, HasEveryPixelOfASingleDepthMap) {
  constexpr double kSigma_px = 0.5;
  Drive(1, {.noise_px = kSigma_px, .sigma_px = kSigma_px});
  options_.max_sigma_pct = 0.01;
  const PointCloud cloud = Fuse();
  const auto known = static_cast<std::size_t>(cv::countNonZero(maps_[0].disparity > 0.0F));
  EXPECT_GT(cloud.size(), known * 9 / 10);  // but those seen edge on
  EXPECT_LE(cloud.size(), known);
  std::size_t within_two = 0;
  for (const SurfacePoint& point : cloud) {
    ASSERT_GT(point.sigma_m, 0.0F);
    ASSERT_GT(point.grain_m, 0.0F);
    ASSERT_LT(point.grain_m, 0.1F);
    within_two += std::abs(point.x_in_world.z()) <= 2.0F * point.sigma_m;
  }
  EXPECT_GT(within_two, cloud.size() * 9 / 10);
  options_.max_sigma_m = 0.01;
  const PointCloud sure = Fuse();
  EXPECT_LT(sure.size(), cloud.size());
  for (const SurfacePoint& point : sure) ASSERT_LE(point.sigma_m, 0.01F);
}

// What smoothing took off in all frames is not halved by four of them.
TEST_F(FuseDepthMapsOfGround, AveragesOnlyWhatFramesDoNotShare) {
  Drive(8, {.noise_px = 0.05, .sigma_px = 0.05});
  const PointCloud apart = Fuse();
  for (DepthMap& map : maps_) {
    map.smoothed_pct = cv::Mat(map.disparity.size(), CV_8UC1, cv::Scalar(100));
  }
  Store();
  const PointCloud alike = Fuse();
  ASSERT_EQ(alike.size(), apart.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    ASSERT_EQ(alike[i].x_in_world, apart[i].x_in_world);
    const double factor = alike[i].sigma_m / apart[i].sigma_m;
    ASSERT_GE(factor, std::sqrt(1.5) - 1e-5);  // of two frames
    ASSERT_LE(factor, std::sqrt(4.5) + 1e-5);  // of eight
    sum += factor;
  }
  EXPECT_GT(sum / static_cast<double>(alike.size()), std::sqrt(2.0));  // of more than three
}

TEST_F(FuseDepthMapsOfGround, HasFinerVoxelsOnSteepFaces) {
  Drive(4, {.noise_px = 0.05, .sigma_px = 0.05});
  options_.min_observations = 1;
  voxel_m_ = 0.04;  // larger than these small images' pixels
  const auto level = static_cast<double>(Fuse().size());
  const Rigid3 wall_from_ground{
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX())),
      Eigen::Vector3d::Zero()};
  for (PosedDepth& depth : depths_) {
    depth.world_from_left = wall_from_ground * depth.world_from_left;
  }
  EXPECT_GT(static_cast<double>(Fuse().size()), 2.0 * level);
  options_.steep_voxel_share = 1.0;
  EXPECT_NEAR(static_cast<double>(Fuse().size()), level, 0.1 * level);
}

TEST_F(FuseDepthMapsOfGround, AveragesNoiseAway) {
  voxel_m_ = 0.2;
  Drive(7, {.noise_px = 0.2});
  options_.min_observations = 1;
  const auto rms_m = [&](int neighbours, int min_views) {
    options_.neighbours = neighbours;
    options_.min_views = min_views;
    return RmsHeightM(Fuse());
  };
  EXPECT_LT(rms_m(6, 2), 0.6 * rms_m(0, 1));
}

TEST_F(FuseDepthMapsOfGround, DropsWhatNeighboursSeeThrough) {
  Drive(5, {.noise_px = 0.1});
  cv::Mat wrong = maps_[2].disparity(cv::Rect(100, 100, 60, 60));
  wrong *= 1.5F;  // a third nearer: half a metre above the ground
  Store();
  EXPECT_LT(HighestM(), 0.1);
  options_.neighbours = 0;
  options_.ahead = 0;  // they see through it as well
  options_.min_views = 1;
  options_.min_observations = 1;
  EXPECT_GT(HighestM(), 0.2);
}

TEST_F(FuseDepthMapsOfGround, DropsWhatAFrameAheadSeesThroughThoughAllNearOnesAgree) {
  const Plate plate{{2.9, -0.3}, {3.3, 0.3}, 0.3};
  for (int i = 0; i < 8; ++i) {
    GroundView view{.noise_px = 0.05, .sigma_px = 0.1};
    if (i < 3) view.plate = plate;
    AddView(0.17 * i, view);
  }
  Store();
  options_.neighbours = 2;
  EXPECT_LT(HighestM(), 0.1);
  EXPECT_THAT(left_out_, testing::IsEmpty());
  options_.ahead = 0;
  EXPECT_GT(HighestM(), 0.25);
}

TEST_F(FuseDepthMapsOfGround, LeavesPointsToFramesAheadThatSeeThemBetter) {
  Drive(12, {.noise_px = 0.1});
  options_.neighbours = 2;
  const PointCloud with_ahead = Fuse();
  options_.ahead = 0;
  const PointCloud without = Fuse();
  EXPECT_LT(WorstSigmaM(with_ahead), 0.75 * WorstSigmaM(without));
  EXPECT_EQ(CoveredSquares(with_ahead), CoveredSquares(without));
}

TEST_F(FuseDepthMapsOfGround, LeavesOutAFrameWhosePoseIsWrong) {
  Drive(8, {.noise_px = 0.05, .sigma_px = 0.05});
  for (const std::size_t wrong : {0, 3, 7}) {
    // Upwards: flat ground looks the same from beside.
    depths_[wrong].world_from_left.translation.z() += 0.1;
    const double highest_m = HighestM();
    EXPECT_THAT(left_out_, testing::ElementsAre(wrong));
    EXPECT_LT(highest_m, 0.03);
    depths_[wrong].world_from_left.translation.z() -= 0.1;
  }
}

TEST_F(FuseDepthMapsOfGround, LosesNoGroundToAFrameWithAWrongPose) {
  Drive(8, {.noise_px = 0.05, .sigma_px = 0.05});
  depths_[3].world_from_left.translation.z() += 0.1;
  const auto beside_it = CoveredSquares(Fuse());
  depths_.erase(depths_.begin() + 3);
  EXPECT_EQ(beside_it, CoveredSquares(Fuse()));
}

TEST_F(FuseDepthMapsOfGround, LosesNoGroundToAFalseMatchBehindIt) {
  Drive(8, {.noise_px = 0.05, .sigma_px = 0.05});
  const auto before = CoveredSquares(Fuse());
  cv::Mat wrong = maps_[3].disparity(cv::Rect(100, 100, 60, 60));
  wrong *= 0.8F;  // seems to look through the ground
  Store();
  EXPECT_EQ(CoveredSquares(Fuse()), before);
}

TEST_F(FuseDepthMapsOfGround, LeavesOutNoneOfSoundFrames) {
  Drive(8, {.noise_px = 0.05, .sigma_px = 0.05});
  Fuse();
  EXPECT_THAT(left_out_, testing::IsEmpty());
}

TEST_F(FuseDepthMapsOfGround, DropsUncertainPoints) {
  Drive(4, {.noise_px = 0.1});
  const std::size_t all = Fuse().size();
  options_.max_sigma_m = 0.03;
  const PointCloud certain = Fuse();
  ASSERT_GT(certain.size(), 1000U);
  EXPECT_LT(certain.size(), all);
  for (const SurfacePoint& point : certain) ASSERT_LE(point.sigma_m, 0.03F);
}

TEST_F(FuseDepthMapsOfGround, DoesNotDependOnTheOrderOfFrames) {
  Drive(5, {.noise_px = 0.1});
  const PointCloud forwards = Fuse();
  std::reverse(depths_.begin(), depths_.end());
  const PointCloud backwards = Fuse();
  ASSERT_EQ(forwards.size(), backwards.size());
  for (std::size_t i = 0; i < forwards.size(); ++i) {
    ASSERT_LT((forwards[i].x_in_world - backwards[i].x_in_world).norm(), 1e-5F);
  }
}

TEST_F(FuseDepthMapsOfGround, EvensOutAStepOfTheExposure) {
  Drive(8, {});
  for (std::size_t i = 4; i < maps_.size(); ++i) maps_[i].colour *= 2.0;
  Store();
  int least = 255, most = 0;
  for (const SurfacePoint& point : Fuse()) {
    least = std::min<int>(least, point.rgb[2]);
    most = std::max<int>(most, point.rgb[2]);
  }
  // Half the brightness of the later frames, but for the part of it that each gives back.
  EXPECT_GE(least, 29);
  EXPECT_LE(most, 36);
}

TEST_F(FuseDepthMapsOfGround, DoesNotDependOnTheNumberOfThreads) {
  Drive(3, {.noise_px = 0.1});
  const PointCloud several = Fuse();
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PointCloud one = Fuse();
  ASSERT_EQ(several.size(), one.size());
  for (std::size_t i = 0; i < several.size(); ++i) {
    ASSERT_EQ(several[i].x_in_world, one[i].x_in_world);
    ASSERT_EQ(several[i].normal, one[i].normal);
    ASSERT_EQ(several[i].sigma_m, one[i].sigma_m);
  }
}

TEST_F(FuseDepthMapsOfGround, NamesAMissingDepthMap) {
  Drive(2, {});
  depths_[1].key = "another key";
  EXPECT_THAT(MessageOf<DataError>([&] { Fuse(); }), testing::HasSubstr(depths_[1].path.string()));
}

TEST_F(FuseDepthMapsOfGround, LeavesNoScratchBehind) {
  Drive(2, {});
  Fuse();
  EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "scratch"));
  depths_[1].key = "another key";
  EXPECT_THROW(Fuse(), DataError);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "scratch"));
}

TEST(FusionOptions, RefusesWhatMakesNoSense) {
  EXPECT_NO_THROW(RequireValid(FusionOptions{}));
  EXPECT_NO_THROW(RequireValid(FusionOptions{.neighbours = 2, .min_views = 3}));
  EXPECT_THROW(RequireValid(FusionOptions{.neighbours = 2, .min_views = 4}), UsageError);
  EXPECT_THROW(RequireValid(FusionOptions{.better_view_share = 1.1}), UsageError);
}

}  // namespace
}  // namespace rigmap
