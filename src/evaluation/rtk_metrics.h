// How far a trajectory is from the fixes of a satellite receiver, and how far noise of these alone
// would put it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <vector>

#include "georeference/fix_pairs.h"

namespace rigmap {

// A figure and what a perfect trajectory would get for it: the root mean square, or the standard
// deviation of `scale`, that the stated sigmas of the fixes make, less what the fit takes up.
struct JudgedFigure {
  double value = 0.0;
  double noise = 0.0;
};

// Displacements between fixes that lie segment_m or just over apart along the way: root mean square
// of their errors in per cent of the way between them. Fixes tell no rotation, so that
// displacements are compared in the plane as the whole path was laid on it.
struct RtkDrift {
  double segment_m = 0.0;
  int count = 0;
  JudgedFigure horizontal_pct, height_pct;
};

struct RtkMetrics {
  int fixes = 0;
  double path_m = 0.0;            // horizontal, from fix to fix
  JudgedFigure horizontal_rms_m;  // as the plane was laid
  JudgedFigure height_rms_m;      // about their mean: the world's z is up
  // Of 90 in 100 fixes: horizontal and height errors (about their mean) are no larger.
  double ce90_m = 0.0, le90_m = 0.0;
  double height_drift_pct = 0.0;  // slope of the height's error over the way
  double height_drift_noise_pct = 0.0;
  std::optional<JudgedFigure> scale;  // truth / estimate in the plane; nothing without a path
  std::vector<RtkDrift> drift;        // over 5, 10, 25, 50 and 100 m, as far as the path goes
};

// Nothing for fewer than four pairs, which leave no residuals that tell anything.
std::optional<RtkMetrics> CompareRtk(std::span<const FixPair> pairs, const RtkAlignment& alignment);

// Keys of evaluation.json's `rtk`: path_m, rms_pct, noise_m, noise_pct, height_rms_m,
// height_noise_m, ce90_m, le90_m, height_drift_pct, height_drift_noise_pct, scale, scale_noise,
// scale_error_pct, and `drift`, a list of segment_m, count, horizontal_pct, horizontal_noise_pct,
// height_pct, height_noise_pct.
nlohmann::ordered_json ToJson(const RtkMetrics& metrics);

}  // namespace rigmap
