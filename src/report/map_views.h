// How high each spot of a map lies, how many images show it, and how finely.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "scene/point_cloud.h"
#include "scene/trajectory.h"

namespace rigmap {

// Square cells of the world, seen from above, where all points lie but one in a hundred at either
// end of each axis: a few far ones would leave nearly all cells empty.
struct MapViews {
  Eigen::Vector2d low_m = Eigen::Vector2d::Zero();  // the first cell's corner
  double cell_m = 0.0;
  int columns = 0, rows = 0;
  std::vector<int> images;  // per cell, row by row, the lowest y first; 0 where the map is empty
  std::vector<double> heights_m;  // likewise, the mean of the cell's points; nan where it is empty
  double median_images = 0.0;
  int usual_most_images = 0;    // that nineteen in twenty cells have at most
  double median_pixel_m = 0.0;  // ground sample distance: a pixel's width in the nearest image
};

// Of the left images whose pose was measured. An image shows a cell if the middle of the cell's
// points lies in it, no further away than where nineteen in twenty cells have their nearest image
// (and no further than that cell's own): a camera that looks at the horizon shows everything. What
// may stand in between is not asked. Nothing without points or poses.
std::optional<MapViews> ViewsOf(const PointCloud& points, const Camera& left,
                                const Trajectory& trajectory);

}  // namespace rigmap
