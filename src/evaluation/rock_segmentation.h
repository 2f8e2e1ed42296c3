// Rocks found in a map by their height above the ground.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/options.h"
#include "evaluation/height_grid.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in rock_segmentation.cc.
struct RockSegmentationOptions {
  static constexpr const char* kSection = "rocks";

  double min_height_m = 0.08;
  double min_height_sigmas = 5.0;
  double min_top_m = 0.15;
  double min_width_m = 0.2;

  OptionFields Fields();
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
// Of a PLY file, block by block; throws DataError naming it.
RockSegmentation SegmentRocksIn(const std::filesystem::path& ply,
                                const RockSegmentationOptions& options = {});
RockSegmentation SegmentRocks(const PointCloud& cloud, const RockSegmentationOptions& options = {});

}  // namespace rigmap
