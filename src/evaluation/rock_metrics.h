// Whether the rocks of a map stand where the true ones do, as large and as single.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "evaluation/map_over_truth.h"

namespace rigmap {

// Axes of both: along the view, across it (to its left), up. The view is the mean direction in
// which the true poses see the rock. Sigmas are one standard deviation.

// The translation that best lays the true surface onto the map.
struct RockShift {
  Eigen::Vector3d along_axes_m = Eigen::Vector3d::Zero(), sigma_m = Eigen::Vector3d::Zero();
  int directions =
      0;  // 1 to 3 that the rock's faces determine; along the others nothing is shifted
};

// The factors by which the true surface, stretched and shifted, comes to lie best on the map.
struct RockStretch {
  Eigen::Vector3d along_axes = Eigen::Vector3d::Zero(),
                  sigma = Eigen::Vector3d::Zero();  // 1 is true
  double rms_m = 0.0;                               // of what both leave of patches of 5 cm
  double doubled_share =
      0.0;  // of patches of 3 cm: the map has two sheets there, 1 cm apart or more
};

// Of the map points within 30 cm of the rock and more than 5 cm above its sand, the shares that lie
// over 3 and over 4 cm from any true surface: a second copy, smear, flying points.
struct RockGhosts {
  double over_3cm_share = 0.0, over_4cm_share = 0.0;
};

// A rock against its visible true surface.
struct RockMetrics {
  TrueRock rock;
  double from_path_m = 0.0;        // in plan, from the nearest true pose
  std::size_t visible_points = 0;  // of the true surface
  double completeness = 0.0;       // share of them with a map point within 2 cm
  // Nothing where the map shows too little of the rock's upper part (rock_deformation.h).
  std::optional<RockShift> shift;
  std::optional<RockStretch> stretch;
  std::optional<double> top_m;  // the map's height over the true top; nothing if that is hidden
  std::optional<RockGhosts> ghosts;  // nothing without points there

  bool Found() const { return completeness >= 0.5; }
};

// The rocks within 3.5 m of the true poses with at least 1000 visible points, in the order of the
// truth. Of rocks that touch each has the points nearest its own centre. Works on several rocks at
// once with TBB; the result does not depend on the threads.
std::vector<RockMetrics> CompareRocks(const MapOverTruth& map);

// The keys of evaluation.json, rounded as printed: rocks, found, the worst of all rocks -
// shift_max_mm, stretch_max_off (of those with sigma_stretch below 0.02, stretch_counted of them),
// top_max_mm, ghost_max_pct, ghost_4cm_max_pct, doubled_max_pct; null where no rock has it - and
// each: [{size, x, y, distance_m, visible, complete_2cm, found, shift_mm, stretch, sigma_stretch,
// top_mm, ghost_pct, shift_vector_mm, shift_directions, sigma_shift_mm, rms_mm, doubled_pct,
// ghost_4cm_pct}, ...]. Of what does not exist the first five are null, the others have no key.
nlohmann::ordered_json ToJson(const std::vector<RockMetrics>& rocks);

}  // namespace rigmap
