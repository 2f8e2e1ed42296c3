// Options of the stage `odometry`.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in odometry_options.cc.
struct OdometryOptions {
  static constexpr const char* kSection = "odometry";

  double keypoint_noise_px = 0.3;
  double disparity_noise_px = 0.15;
  double shared_noise = 2.0;
  double max_sigmas = 4.0;
  int min_inliers = 15;
  double keyframe_min_seen_share = 0.5;
  double keyframe_max_shift_share = 0.15;
  double stand_still_sigmas = 4.0;
  double search_radius_px = 60.0;
  double speed_change_share = 0.3;
  double turn_change_rad_per_s = 0.1;

  OptionFields Fields();
};

}  // namespace rigmap
