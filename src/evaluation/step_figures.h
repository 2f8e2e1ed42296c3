// What of evaluation.json's `steps` tells one step from another.
#pragma once

#include <array>

namespace rigmap {

// Paths below a step, those that it has: beside poses, a prism's track (prism_metrics.h) and
// satellite fixes (rtk_metrics.h).
inline constexpr std::array kStepFigures{"ate_se3_m",          "ate_se3_pct", "scale_error_pct",
                                         "rpe_t_pct",          "rms_se2_m",   "rms_se2_pct",
                                         "rtk/rms_residual_m", "rtk/ce90_m",  "rtk/height_rms_m",
                                         "rtk/scale_error_pct"};

}  // namespace rigmap
