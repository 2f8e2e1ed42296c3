// Rocks found in a map by their height above the ground.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/options.h"
#include "evaluation/height_grid.h"

namespace rigmap {

struct RockSegmentationOptions {
  // m; cells this far above the ground belong to rocks, footprints and tracks do not. A quarter of
  // the smallest rocks of Katwijk.
  double min_height_m = 0.08;
  // The same in sigmas of the cells' heights about the ground, where the map is noisier than that.
  double min_height_sigmas = 5.0;
  // m; the top of a rock is at least this far above the ground. Half the smallest rocks' height.
  double min_top_m = 0.15;
  // m; a rock is at least this long. Half the smallest rocks' width, since the map may show only
  // one face of it.
  double min_width_m = 0.2;

  OptionFields Fields() {
    return {{"min_height_m", &min_height_m},
            {"min_height_sigmas", &min_height_sigmas},
            {"min_top_m", &min_top_m},
            {"min_width_m", &min_width_m}};
  }
  void Validate() const;
};

// As far as the map shows it: of a rock seen from one side, that side. World axes, metres.
struct SegmentedRock {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // of its footprint's cells
  double width_m = 0.0;                              // its footprint's largest extent
  double height_m = 0.0;  // of its top above the mean ground of its footprint
  double top_z_m = 0.0;
  int points = 0;  // of the map
};

struct RockSegmentation {
  std::vector<SegmentedRock> rocks;  // highest first
  GroundLevel ground;
  double height_limit_m = 0.0;  // above the ground, that cells were judged by
};

// Cells above the ground, put together across gaps of a cell. A lone high point among low ones
// makes no top. Rocks that touch become one. Throws UsageError for options out of range.
RockSegmentation SegmentRocks(const HeightGrid& grid, const RockSegmentationOptions& options = {});
RockSegmentation SegmentRocks(const PointCloud& cloud, const RockSegmentationOptions& options = {});

}  // namespace rigmap
