// Points of the true surface of the world near the rover's path.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "simulation/mesh.h"
#include "simulation/world.h"

namespace rigmap {

// In the world's frame, metres; the normal is of unit length and points up or outwards.
struct SurfaceSample {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  SurfaceKind kind = SurfaceKind::kSand;
};

// The surface in batches: one per row of the sand's mesh from south to north, then one per boulder,
// then one per piece of debris.
//   sand      every node of the fine mesh that no boulder covers; the normal is of the slope
//   between
//             the neighbouring nodes
//   boulders  triangles cut into equal ones no larger than a square centimetre: their centroids,
//             facet normals
//   debris    the same with squares of 3 mm
// What lies under the sand or in a boulder is left out.
class SurfaceSampler {
 public:
  // Of points within `reach_m` of the path, horizontally. `path`: places along the way, not empty,
  // with straight lines between. `world` must outlive this and be built along the same way. Beyond
  // World::kFineSand_m the sand is finer here than as rendered.
  SurfaceSampler(const World& world, std::span<const Eigen::Vector2d> path, double reach_m);

  int batch_count() const;
  // Of the batch 0 <= batch < batch_count(), in a fixed order. Thread-safe.
  std::vector<SurfaceSample> Batch(int batch) const;

  const World& world() const { return world_; }

 private:
  std::vector<SurfaceSample> SandRow(int row) const;
  SurfaceSample SandNode(int column, int row) const;
  std::vector<SurfaceSample> Facets(const Mesh& mesh, SurfaceKind kind) const;
  bool IsNearPath(const Eigen::Vector2d& position) const;
  bool IsInBoulder(const Eigen::Vector3d& position) const;

  const World& world_;
  std::vector<Eigen::Vector2d> path_;  // closely spaced
  double reach_m_;
  std::vector<Eigen::AlignedBox3d> boxes_of_boulders_;
  int first_row_ = 0, row_count_ = 0;
};

}  // namespace rigmap
