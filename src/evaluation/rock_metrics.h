// Whether the rocks of a map stand where the true ones do, as large and as single.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "evaluation/map_over_truth.h"
#include "evaluation/rock_deformation.h"

namespace rigmap {

// A rock against its visible true surface.
struct RockMetrics {
  TrueRock rock;
  std::size_t visible_points = 0;  // of the true surface
  double completeness = 0.0;       // share of them with a map point within 2 cm
  // Axes: along the view from the nearest true pose, horizontally across it (to its left), up.
  // Nothing where fewer than 100 map points lie within 6 cm.
  std::optional<RockDeformation> deformation;
  // Of the map points within 30 cm of the rock and more than 5 cm above its sand, the share that is
  // over 4 cm from any true surface: a second copy, smear, flying points. Nothing without such.
  std::optional<double> ghost_share;
  // The 99.5th percentile of the heights of map points within 10 cm, minus the highest visible
  // point. Nothing without such points, or without ghost_share.
  std::optional<double> top_m;

  bool Found() const { return completeness >= 0.5; }
};

// The rocks within 3.5 m of the true poses with at least 1000 visible points, in the order of the
// truth. Of rocks that touch each has the points nearest its own centre. Works on several rocks at
// once with TBB; the result does not depend on the threads.
std::vector<RockMetrics> CompareRocks(const MapOverTruth& map);

// The keys of evaluation.json, rounded as printed: rocks, found, the worst of all rocks that have a
// deformation - shift_max_mm, stretch_max_off (where sigma_stretch is below 0.02), top_max_mm,
// ghost_max_pct, null without such a rock - and each: [{size, x, y, visible, complete_2cm, found,
// shift_mm, stretch, sigma_stretch, top_mm (may be null), ghost_pct}, ...]. What does not exist has
// no key.
nlohmann::ordered_json ToJson(const std::vector<RockMetrics>& rocks);

}  // namespace rigmap
