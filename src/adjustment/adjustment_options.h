// Options of the stage `adjustment`.
#pragma once

#include <string>

#include "core/options.h"

namespace rigmap {

struct AdjustmentOptions {
  // Which part of the calibration is corrected: "none"; "rotation" of the right eye;
  // "rotation+focal", also one factor on all focal lengths; "all", also principal points, k1 and a
  // factor between the eyes' focal lengths; "auto", all, but only where the images contradict the
  // calibration by more than refine_sigmas. The baseline's length always stays: it is where metres
  // come from.
  std::string refine_rig = "auto";
  double refine_sigmas = 4.0;
  // How far a calibration may be off: sigmas of the prior that draws the rig back to it.
  double rig_prior_deg = 0.1;
  double focal_prior_pct = 0.5;
  double principal_point_prior_px = 1.0;
  double distortion_prior = 0.005;  // of k1
  // Residuals beyond so many robust sigmas are weighted down (Huber); observations beyond the
  // second limit are dropped between rounds. The sigma is the part's own, at least the floor (px).
  double huber_sigmas = 2.0;
  double outlier_sigmas = 5.0;
  double min_noise_px = 0.05;
  // Sigmas of poses and rig grow by this, beside what residuals of whole tracks say: noise that all
  // observations of a frame share leaves no trace in residuals. Measured over simulated drives.
  double shared_noise = 2.0;
  // Points further than this, in baselines, hardly move the result and are left out: at 1000
  // their disparity is below a pixel.
  double max_depth_baselines = 1000.0;
  int rounds = 3;
  int max_iterations = 50;
  // Of the last round; 1e-4 before. A damped solver stopped early on long parts at 1e-5 (13.9
  // instead of 6.9 mm at 400 pairs); undamped, poses of 103 pairs do not change from here to 1e-8.
  double function_tolerance = 1e-7;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
