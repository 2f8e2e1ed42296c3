// The world that the simulated rover drives through: sand, boulders, debris, and what closes the
// horizon, as geometry that rays can be cast at (Embree).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "simulation/boulders.h"
#include "simulation/mesh.h"
#include "simulation/scene_options.h"
#include "simulation/surface_shading.h"
#include "simulation/terrain.h"

namespace rigmap {

// Where a ray meets the world first.
struct SurfaceHit {
  double distance_m = 0.0;  // along the unit direction
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal =
      Eigen::Vector3d::UnitZ();  // of the facet, unit, towards the ray's origin
  SurfaceKind kind = SurfaceKind::kSand;
};

// Coordinates are local east, north, up in metres. Immutable once built; all members may be called
// from several threads. Equal options and outline give an equal world.
class World {
 public:
  // `outline`: places along the way that the rover will drive, closer together than 0.5 m. The sand
  // is as fine as options.sand_cell_m within kFineSand_m of them, and coarser farther out.
  World(const SceneOptions& options, std::span<const Eigen::Vector2d> outline);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  static constexpr double kFineSand_m = 4.2;

  // `direction` is a unit vector. Nothing: the ray goes to the sky.
  std::optional<SurfaceHit> Cast(const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& direction) const;
  // True if anything stands between two points; the last millimetre at either end does not count.
  bool IsOccluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  const SceneOptions& options() const;
  // Within kFineSand_m of the outline, the sand as rendered passes through
  // (x, y, Height(x, y, sand_cell_m)) at all whole multiples of options().sand_cell_m, and is made
  // of two triangles between each four.
  const Terrain& terrain() const;
  const std::vector<Boulder>& boulders() const;
  const std::vector<Mesh>& debris() const;
  // Centres of the marker discs: white, kMarkerRadius_m, on a dark square, flat, 1 cm above the
  // sand.
  const std::vector<Eigen::Vector3d>& markers() const;
  static constexpr double kMarkerRadius_m = 0.04;

  struct Parts;  // world_parts.h
  const Parts& parts() const { return *parts_; }

 private:
  std::unique_ptr<Parts> parts_;
};

}  // namespace rigmap
