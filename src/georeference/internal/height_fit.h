// The height of a world by satellite fixes, and what they say of its up.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "georeference/earth_fit.h"

namespace rigmap {

// One fix over the path: where the path had the antenna (x, y of the world), how far the fix lies
// above it, and the sigma of that. Metres.
struct HeightPair {
  Eigen::Vector2d x_in_world;
  double rise_m = 0.0;
  double sigma_m = 0.0;
};

struct HeightFit {
  std::vector<HeightPair> used;
  double rise_m = 0.0;  // weighted mean
  double sigma_m = 0.0;
  double rms_m = 0.0;
  std::optional<TiltCheck> along, across;
  double length_m = 0.0, width_m = 0.0;  // of the path: four root mean squares from its middle
};

// Those within four sigmas, or four times the scatter of most, of the median. Sigmas are scaled up
// where residuals are larger than stated; that of the height also where they are like those before
// them. Pairs in order of time, at least one.
HeightFit FitHeight(std::span<const HeightPair> pairs);

}  // namespace rigmap
