// A flat beach with round rocks, of which everything is known.
#pragma once

#include <vector>

#include "evaluation/map_over_truth.h"
#include "evaluation/rock_metrics.h"

namespace rigmap {

// A rock is the upper half of a ball that lies on the sand (z = 0).
struct Dome {
  Eigen::Vector2d centre;
  double radius_m = 0.25;
};

// Seen along y from the path, whose middle is next to it.
inline const Dome kDome{{1.0, 1.5}, 0.25};

// Sand on a 1 cm grid, x from 0.5 to 1.7 m and y from -4 to 4 m, all visible, except under domes,
// whose points stand about 1 cm apart. The path leads from (0, 0) to (2, 0), 1 m above the sand.
MapTruth MakeBeach(const std::vector<Dome>& domes);

// The true surface as a map. Equal to it, or each of its points displaced.
using Points = std::vector<Eigen::Vector3f>;
inline Points PerfectMap(const MapTruth& truth) { return truth.surface.x_in_truth; }
Points Displaced(Points points, const Eigen::Vector3f& by);
Points PointsOfKind(const MapTruth& truth, bool rock);  // the rocks', or the sand's
Points Together(Points points, const Points& more);

// Laid where the truth says it lies.
inline MapOverTruth AlreadyAligned(Points map, const MapTruth& truth) {
  return MapOverTruth(std::move(map), Rigid3{}, truth);
}

// Of a beach with one rock. Throws std::runtime_error where another number of rocks is judged.
RockMetrics OnlyRock(const Points& map, const MapTruth& truth);

}  // namespace rigmap
