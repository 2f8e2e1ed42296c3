// A map as a report shows it: no more points than a browser likes, and what is said of all of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "evaluation/rock_segmentation.h"
#include "scene/point_cloud.h"

namespace rigmap {

struct ThinCloud {
  PointCloud points;  // evenly taken from the file
  std::uint64_t count_in_map = 0;
  double finest_m = 0.0;                 // smallest grain; 0: unknown
  std::optional<double> median_sigma_m;  // of the points kept
  std::optional<double> median_observations;
  double area_m2 = 0.0;  // ground that is covered, in cells of heights, seen from above
  // Rises above the ground, highest first; nothing where the map is too coarse to tell of rocks,
  // its finest points standing for more than a cell of heights, or shows what is larger than any.
  std::optional<std::vector<SegmentedRock>> rocks;
};

// Of dense.ply or sparse.ply, read block by block. Throws DataError naming the file.
ThinCloud ReadThinCloud(const std::filesystem::path& ply, std::size_t max_points);

}  // namespace rigmap
