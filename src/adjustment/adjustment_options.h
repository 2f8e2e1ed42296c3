// Options of the stage `adjustment`.
#pragma once

#include "core/options.h"
#include "scene/calibration.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in adjustment_options.cc.
struct AdjustmentOptions {
  static constexpr const char* kSection = "adjustment";

  RigRefinement refine_rig = RigRefinement::kAuto;
  double refine_sigmas = 3.0;
  double rig_prior_deg = 0.1;
  double focal_prior_pct = 0.5;
  double aspect_prior_pct = 0.1;
  double principal_point_prior_px = 0.5;
  double distortion_prior_px = 1.0;
  double board_noise_px = 0.7;
  double lens_field_px = 0.1;
  double huber_sigmas = 2.0;
  double outlier_sigmas = 5.0;
  double min_noise_px = 0.05;
  double shared_noise = 2.0;
  double max_depth_baselines = 1000.0;
  int rounds = 3;

  OptionFields Fields();
};

}  // namespace rigmap
