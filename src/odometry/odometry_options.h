// Options of the stage `odometry`.
#pragma once

#include "core/options.h"

namespace rigmap {

struct OdometryOptions {
  // One standard deviation (px) of a matched keypoint and of a stereo disparity, for weights and
  // sigmas. Measured on sand: SIFT matches scatter by 0.3 px, aligned stereo partners by 0.1 px.
  double keypoint_noise_px = 0.3;
  double disparity_noise_px = 0.15;
  // Sigmas of a motion grow by this: noise that all matches of a frame share leaves no trace in
  // their residuals. As in the adjustment.
  double shared_noise = 2.0;
  // A match is an inlier within so many sigmas.
  double max_sigmas = 4.0;
  // Fewer agreeing matches than this do not make a motion: wrong ones reach 10 by chance.
  int min_inliers = 15;
  // A new keyframe is made once a smaller share of the keyframe's stereo points is still seen, or
  // once the median point has moved by more than this share of the image width.
  double keyframe_min_seen_share = 0.5;
  double keyframe_max_shift_share = 0.15;
  // Motion is taken for real once it exceeds so many of its own sigmas; below, the rig stands.
  double stand_still_sigmas = 4.0;
  // Half width (px) of the search around the predicted place, before matching everywhere.
  double search_radius_px = 60.0;
  // One standard deviation of the change of speed (share of the larger speed) and of turn rate
  // (rad/s) that a frame without motion of its own is allowed: what a rover's wheels can do.
  double speed_change_share = 0.3;
  double turn_change_rad_per_s = 0.1;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
