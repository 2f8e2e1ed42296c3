#include "fusion/internal/layered_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr double kFinestVoxelM = 0.01;

SurfaceSample Sample(double x_m, double y_m, double z_m, double sigma_m) {
  SurfaceSample sample;
  sample.x_in_world = {x_m, y_m, z_m};
  sample.normal = Eigen::Vector3f::UnitZ();
  sample.sigma_m = static_cast<float>(sigma_m);
  sample.cosine = 0.25F;
  return sample;
}

SurfaceSample Steep(double x_m, double y_m, double z_m, double sigma_m) {
  SurfaceSample sample = Sample(x_m, y_m, z_m, sigma_m);
  sample.normal = Eigen::Vector3f::UnitX();
  return sample;
}

class LayeredGridInScratch : public testing::Test {
 protected:
  PointCloud Drained(const std::vector<SurfaceSample>& samples,
                     std::size_t most_voxels = 1'000'000) {
    LayeredGrid grid(kFinestVoxelM, 0.5, folder_.Path() / "scratch", most_voxels);
    for (std::size_t i = 0; i < samples.size(); i += 1000) {
      const std::size_t end = std::min(samples.size(), i + 1000);
      grid.Add(std::span(samples).subspan(i, end - i));
    }
    PointCloud cloud;
    grid.Drain(options_, [&](std::span<const SurfacePoint> points) {
      cloud.insert(cloud.end(), points.begin(), points.end());
    });
    return cloud;
  }

  TemporaryFolder folder_;
  FusionOptions options_{.min_observations = 1};
};

TEST_F(LayeredGridInScratch, IsAsCoarseAsWhatIsKnown) {
  const LayeredGrid grid(kFinestVoxelM, 0.5, folder_.Path() / "scratch", 1000);
  const auto layer = [&](double sigma_m, double off_m, double pixel_m, float up = 1.0F) {
    SurfaceSample sample = Sample(0.0, 0.0, 0.0, sigma_m);
    sample.cosine = static_cast<float>(off_m / sigma_m);
    sample.pixel_m = static_cast<float>(pixel_m);
    sample.normal.z() = up;
    return grid.LayerOf(sample);
  };
  EXPECT_EQ(layer(0.001, 0.001, 0.001), 0);
  EXPECT_EQ(layer(0.029, 0.001, 0.001), 0);
  EXPECT_EQ(layer(0.031, 0.001, 0.001), 2);  // cubes of 4 cm
  EXPECT_EQ(layer(0.079, 0.001, 0.001), 3);
  EXPECT_EQ(layer(0.016, 0.014, 0.001), 0);
  EXPECT_EQ(layer(0.016, 0.016, 0.001), 1);
  EXPECT_EQ(layer(0.016, 0.0074, 0.001, 0.1F), 0);  // steep: in cubes of half the side
  EXPECT_EQ(layer(0.016, 0.0076, 0.001, 0.1F), 1);
  EXPECT_EQ(layer(0.001, 0.001, 0.019), 0);
  EXPECT_EQ(layer(0.001, 0.001, 0.021), 2);
  EXPECT_EQ(layer(0.001, 0.001, 0.15), 4);
  EXPECT_EQ(layer(100.0, 0.001, 0.1), LayeredGrid::kLayers - 1);
}

TEST_F(LayeredGridInScratch, SaysTheGrainOfEachPoint) {
  const PointCloud cloud = Drained({Sample(0.0, 0.0, 0.0, 0.01), Sample(5.0, 0.0, 0.0, 0.05)});
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_FLOAT_EQ(cloud[0].grain_m, 0.01F);
  EXPECT_FLOAT_EQ(cloud[1].grain_m, 0.08F);
}

TEST_F(LayeredGridInScratch, LeavesOutWhatIsKnownBetter) {
  const SurfaceSample fine = Sample(0.005, 0.005, 0.005, 0.01);
  EXPECT_EQ(Drained({fine, Sample(0.03, 0.03, 0.03, 0.05)}).size(), 1U);   // in the same cube
  EXPECT_EQ(Drained({fine, Sample(0.03, 0.03, -0.03, 0.05)}).size(), 1U);  // in the cube above
  EXPECT_EQ(Drained({fine, Sample(0.03, 0.03, 0.17, 0.05)}).size(), 2U);   // two cubes below
  const SurfaceSample middling = Sample(0.005, 0.005, 0.005, 0.05);
  EXPECT_EQ(Drained({middling, Sample(0.1, 0.1, 0.1, 0.3)}).size(), 1U);
}

TEST_F(LayeredGridInScratch, LevelGroundGoesOnWhereTheFinerLayerEnds) {
  const SurfaceSample fine = Sample(0.005, 0.005, 0.005, 0.01);
  EXPECT_EQ(Drained({fine, Sample(-0.03, 0.1, -0.07, 0.05)}).size(), 2U);
  EXPECT_EQ(Drained({fine, Steep(-0.03, 0.1, -0.07, 0.05)}).size(), 1U);
}

TEST_F(LayeredGridInScratch, LeavesItOutAcrossTheBordersOfTiles) {
  constexpr double kTileM = 2.56;
  for (const double border_m : {-kTileM, 0.0, 3.0 * kTileM}) {
    for (const double side : {-1.0, 1.0}) {
      const double fine_m = border_m + side * 0.005, coarse_m = border_m - side * 0.01;
      EXPECT_EQ(Drained({Sample(fine_m, 0.5, 0.0, 0.01), Steep(coarse_m, 0.5, 0.0, 0.05)}).size(),
                1U);
      EXPECT_EQ(Drained({Sample(0.5, fine_m, 0.0, 0.01), Steep(0.5, coarse_m, 0.0, 0.05)}).size(),
                1U);
    }
  }
}

TEST_F(LayeredGridInScratch, CountsOnlyFinerPointsThatComeOut) {
  options_.min_observations = 2;
  SurfaceSample coarse = Sample(0.03, 0.03, 0.03, 0.05);
  coarse.observations = 2;
  const PointCloud cloud = Drained({Sample(0.005, 0.005, 0.005, 0.01), coarse});
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_FLOAT_EQ(cloud[0].grain_m, 0.08F);
}

TEST_F(LayeredGridInScratch, LeavesOutWhatIsNotKnownToTheSigmaAsked) {
  options_.max_sigma_m = 0.02;
  EXPECT_EQ(Drained({Sample(0.0, 0.0, 0.0, 0.04), Sample(5.0, 0.0, 0.0, 0.05)}).size(), 1U);
}

TEST_F(LayeredGridInScratch, GivesTheSameWhateverIsSetAside) {
  SeededRandom random;
  std::vector<SurfaceSample> samples;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d x = random.Vector(6.0);
    samples.push_back(Sample(x.x(), x.y(), 0.01 * x.z(), random.Uniform(0.005, 0.4)));
  }
  const auto fields = [](const SurfacePoint& point) {
    const auto& x = point.x_in_world;
    return std::tuple(x.x(), x.y(), x.z(), point.grain_m, point.sigma_m, point.observations);
  };
  const PointCloud in_memory = Drained(samples), through_files = Drained(samples, 0);
  ASSERT_GT(in_memory.size(), 1000U);
  ASSERT_EQ(in_memory.size(), through_files.size());
  std::set<float> grains;
  for (std::size_t i = 0; i < in_memory.size(); ++i) {
    ASSERT_EQ(fields(in_memory[i]), fields(through_files[i]));
    grains.insert(in_memory[i].grain_m);
  }
  EXPECT_GE(grains.size(), 4U);
}

}  // namespace
}  // namespace rigmap
