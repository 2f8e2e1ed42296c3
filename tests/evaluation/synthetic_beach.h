// A flat beach with round rocks, of which everything is known.
#pragma once

#include <vector>

#include "evaluation/map_over_truth.h"

namespace rigmap {

// A rock is the upper half of a ball that lies on the sand (z = 0).
struct Dome {
  Eigen::Vector2d centre;
  double radius_m = 0.25;
};

// Sand on a 1 cm grid, x from 0.5 to 1.7 m and y from -4 to 4 m, all visible, except under domes,
// whose points stand about 1 cm apart. The path leads from (0, 0) to (2, 0), 1 m above the sand.
MapTruth MakeBeach(const std::vector<Dome>& domes);

// The true surface as a map. Equal to it, or each of its points displaced.
using Points = std::vector<Eigen::Vector3f>;
inline Points PerfectMap(const MapTruth& truth) { return truth.surface.x_in_truth; }
Points Displaced(Points points, const Eigen::Vector3f& by);

// Laid where the truth says it lies.
inline MapOverTruth AlreadyAligned(Points map, const MapTruth& truth) {
  return MapOverTruth(std::move(map), Rigid3{}, truth);
}

}  // namespace rigmap
