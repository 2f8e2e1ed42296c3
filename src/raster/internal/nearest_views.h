// From where a camera on its path saw the ground.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "raster/cell_frame.h"
#include "raster/internal/point_cells.h"
#include "raster/upper_surface.h"
#include "scene/trajectory.h"

namespace rigmap {

class NearestViews {
 public:
  // Kept by reference.
  NearestViews(const Trajectory& trajectory, const Camera& camera)
      : trajectory_(trajectory), camera_(camera) {}

  // Poses in order of their horizontal distance from a point on the ground.
  struct Around {
    struct View {
      std::size_t pose = 0;
      double distance_m = 0.0;
    };
    Eigen::Vector2d x_in_world;
    std::vector<View> views;
  };
  Around NearTo(const Eigen::Vector2d& x_in_world) const;

  // The nearest camera's position whose image holds the point, whatever stands between; nothing
  // where there is none. Fast where `around` is of a point close by.
  std::optional<Eigen::Vector3d> Find(const Eigen::Vector3d& x_in_world,
                                      const Around& around) const;

 private:
  const Trajectory& trajectory_;
  const Camera& camera_;
};

// Fills view_deg of seen cells: the angle between the surface's normal and the nearest view, the
// same camera for blocks of four by four cells. The grid's first cell is `column`, `row` of the
// frame; it may lie outside.
void AddViewAngles(const NearestViews& views, const PointCells& cells, int column, int row,
                   SurfaceGrid& grid);

}  // namespace rigmap
