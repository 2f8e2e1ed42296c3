#include "fusion/internal/voxel_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr double kCellM = 0.01;

SurfaceSample SampleAt(const Eigen::Vector3d& x, float sigma_m = 0.01F) {
  SurfaceSample sample;
  sample.x_in_world = x;
  sample.normal = {0.0F, 0.0F, 1.0F};
  sample.rgb = {10, 20, 30};
  sample.sigma_m = sigma_m;
  return sample;
}

PointCloud PointsOf(const std::vector<SurfaceSample>& samples, int min_observations = 1) {
  VoxelGrid grid(kCellM);
  for (const SurfaceSample& sample : samples) grid.Add(sample);
  return grid.Points(min_observations, 1.0);
}

TEST(VoxelGrid, GivesASingleSampleBack) {
  const PointCloud points = PointsOf({SampleAt({-1.2345, 2.3456, -0.0001}, 0.02F)});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_LT((points[0].x_in_world - Eigen::Vector3f(-1.2345F, 2.3456F, -0.0001F)).norm(), 1e-6);
  EXPECT_EQ(points[0].rgb, (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_NEAR(points[0].sigma_m, 0.02, 1e-7);
  EXPECT_EQ(points[0].observations, 1);
}

TEST(VoxelGrid, WeighsByInverseVariance) {
  const PointCloud points =
      PointsOf({SampleAt({0.002, 0.005, 0.005}, 0.01F), SampleAt({0.007, 0.005, 0.005}, 0.02F)});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].x_in_world.x(), (4.0 * 0.002 + 0.007) / 5.0, 1e-7);
}

// Two measurements, the better of them seen flatly: weighed by the sigmas along their rays, known
// by those off the surface.
TEST(VoxelGrid, TellsTheSigmaOffTheSurface) {
  SurfaceSample flat = SampleAt({0.002, 0.005, 0.005}, 0.01F);
  flat.cosine = 0.0F;
  EXPECT_NEAR(flat.OffSurfaceM(), 0.004, 1e-8);
  const PointCloud points = PointsOf({flat, SampleAt({0.007, 0.005, 0.005}, 0.02F)});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].x_in_world.x(), (4.0 * 0.002 + 0.007) / 5.0, 1e-7);
  EXPECT_NEAR(points[0].sigma_m, std::sqrt((4.0 * 0.004 * 0.004 + 0.02 * 0.02) / 5.0), 1e-7);
}

TEST(VoxelGrid, KeepsEveryCubeApart) {
  SeededRandom random;
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < 200000; ++i) {
    const Eigen::Vector3d cube(i % 100 - 50, i / 100 % 100 - 50, i / 10000 - 10);
    const Eigen::Vector3d inside = Eigen::Vector3d::Constant(0.5) + random.Vector(0.49);
    samples.push_back(SampleAt(kCellM * (cube + inside)));
  }
  const PointCloud points = PointsOf(samples);
  ASSERT_EQ(points.size(), samples.size());
  const auto cube_of = [](const SurfacePoint& point) {
    const Eigen::Vector3d cube = (point.x_in_world.cast<double>() / kCellM).array().floor();
    return std::vector<double>(cube.data(), cube.data() + 3);
  };
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end(), [&](const auto& a, const auto& b) {
    return cube_of(a) < cube_of(b);
  }));
}

TEST(VoxelGrid, DropsWhatWasSeenTooRarely) {
  std::vector<SurfaceSample> samples(3, SampleAt({0.005, 0.005, 0.005}));
  samples.push_back(SampleAt({1.005, 0.005, 0.005}));
  EXPECT_EQ(PointsOf(samples, 1).size(), 2U);
  EXPECT_EQ(PointsOf(samples, 3).size(), 1U);
  EXPECT_EQ(PointsOf(samples, 4).size(), 0U);
}

TEST(VoxelGrid, DropsWhatIsTooUncertain) {
  VoxelGrid grid(kCellM);
  grid.Add(SampleAt({0.005, 0.005, 0.005}, 0.01F));
  grid.Add(SampleAt({1.005, 0.005, 0.005}, 0.03F));
  EXPECT_EQ(grid.Points(1, 0.02).size(), 1U);
  EXPECT_EQ(grid.Points(1, 0.04).size(), 2U);
}

std::vector<SurfaceSample> RandomSamples(SeededRandom& random, int count) {
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back(SampleAt(random.Vector(0.1), static_cast<float>(random.Uniform(0.01, 0.1))));
  }
  return samples;
}

void ExpectEqual(const PointCloud& found, const PointCloud& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].x_in_world, expected[i].x_in_world);
    ASSERT_EQ(found[i].normal, expected[i].normal);
    ASSERT_EQ(found[i].rgb, expected[i].rgb);
    ASSERT_EQ(found[i].observations, expected[i].observations);
    ASSERT_EQ(found[i].sigma_m, expected[i].sigma_m);
  }
}

TEST(VoxelGrid, GoesOnAfterSaveAndLoadAsIfNothingHadBeen) {
  SeededRandom random;
  const TemporaryFolder folder;
  VoxelGrid saved(kCellM), loaded(kCellM);
  for (const SurfaceSample& sample : RandomSamples(random, 20000)) saved.Add(sample);
  saved.Save(folder.Path() / "voxels");
  loaded.Load(folder.Path() / "voxels");
  EXPECT_EQ(loaded.VoxelCount(), saved.VoxelCount());
  ExpectEqual(loaded.Points(1, 1.0), saved.Points(1, 1.0));
  for (const SurfaceSample& sample : RandomSamples(random, 20000)) {
    saved.Add(sample);
    loaded.Add(sample);
  }
  EXPECT_EQ(loaded.VoxelCount(), saved.VoxelCount());
  ExpectEqual(loaded.Points(1, 1.0), saved.Points(1, 1.0));
}

TEST(VoxelGrid, SavesAndLoadsAnEmptyGrid) {
  const TemporaryFolder folder;
  VoxelGrid(kCellM).Save(folder.Path() / "voxels");
  VoxelGrid loaded(kCellM);
  loaded.Load(folder.Path() / "voxels");
  EXPECT_EQ(loaded.VoxelCount(), 0U);
}

TEST(VoxelGrid, NamesAFileThatHoldsNoVoxels) {
  const TemporaryFolder folder;
  VoxelGrid grid(kCellM);
  for (const auto& path : {folder.Path() / "missing", folder.Write("text", "no voxels at all"),
                           folder.Write("empty", "")}) {
    EXPECT_THAT(MessageOf<DataError>([&] { grid.Load(path); }), testing::HasSubstr(path.string()));
  }
}

TEST(VoxelGrid, RefusesPointsOutsideTheWorld) {
  EXPECT_THROW(PointsOf({SampleAt({20000.0, 0.0, 0.0})}), DataError);
  EXPECT_THROW(PointsOf({SampleAt({0.0, std::nan(""), 0.0})}), DataError);
}

}  // namespace
}  // namespace rigmap
