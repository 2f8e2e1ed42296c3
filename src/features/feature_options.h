// Options of the stage `features`.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in feature_options.cc.
struct FeatureOptions {
  static constexpr const char* kSection = "features";

  int max_keypoints = 1500;
  double half_resolution_above_mpx = 0.6;
  double contrast_threshold = 0.008;
  double faint_contrast_threshold = 0.002;
  double min_depth_baselines = 5.0;
  double epipolar_band_px = 4.0;
  double min_correlation = 0.8;
  double min_uniqueness = 0.05;
  double max_epipolar_sigmas = 4.0;

  OptionFields Fields();
};

}  // namespace rigmap
