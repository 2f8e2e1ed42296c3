// Averages of points in the cubes of a grid.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "scene/point_cloud.h"

namespace rigmap {

// What one frame says about the surface at a point.
struct SurfaceSample {
  Eigen::Vector3d x_in_world;  // metres
  Eigen::Vector3f normal;      // unit, in world; zero where unknown
  std::array<std::uint8_t, 3> rgb{};
  float sigma_m = 0.0F;  // along the viewing rays, > 0, as if its measurements shared no error
  int observations = 1;  // depth pixels it was made from
  float pixel_m = 0.0F;  // what a pixel covers of the surface
  float cosine = 1.0F;   // between its normal and the ray against which it was seen
  float shared = 1.0F;   // by what they do share, its sigma is so many times as large

  // One standard deviation of its distance from the surface. An error along a ray would be off a
  // plane by the cosine; but what a window covers is rough, the more so the flatter it is seen.
  float OffSurfaceM() const;
};

// Cubes are hashed; 64 bytes per touched cube. The grid reaches 2^20 cubes from its corner in each
// direction, up and down from height 0, and 100 km from the origin. Not thread-safe.
class VoxelGrid {
 public:
  explicit VoxelGrid(double voxel_m,
                     const Eigen::Vector2d& corner_in_world = Eigen::Vector2d::Zero());

  // Weighs the sample by 1 / sigma^2. Throws DataError for a point outside the grid.
  void Add(const SurfaceSample& sample);

  // One point per cube with at least `min_observations` and at most `max_sigma_m`, ordered by cube
  // (x, then y, then z). The order of Add changes it by rounding only.
  PointCloud Points(int min_observations, double max_sigma_m) const;

  std::size_t VoxelCount() const { return voxels_.size(); }

  // Writes all that was added, and adds what was written to an empty grid of the same cubes. Throw
  // DataError naming the file.
  void Save(const std::filesystem::path& path) const;
  void Load(const std::filesystem::path& path);

 private:
  struct Voxel {  // weighted sums
    std::uint64_t key = 0;
    std::array<float, 3> offset{}, normal{}, rgb{};  // offset: from the cube's corner, in voxels
    float weight = 0.0F;
    std::uint32_t observations = 0;
    float off = 0.0F;  // of weighted variances off the surface
  };
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;
  static constexpr std::size_t kFirstSlots = 1U << 12U;

  Voxel& At(std::uint64_t key);
  void Index(std::size_t slot_count);  // a power of two
  SurfacePoint PointOf(const Voxel& voxel) const;

  double voxel_m_;
  Eigen::Vector3d corner_;            // in voxels, whole ones
  std::vector<std::uint32_t> slots_;  // open addressing, a power of two; index into voxels_
  std::vector<Voxel> voxels_;
};

}  // namespace rigmap
