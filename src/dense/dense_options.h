// How depth is got from a pair of rectified images.
#pragma once

#include <string>

#include "core/options.h"

namespace rigmap {

struct DenseOptions {
  // "sgm": semi-global matching over eight paths (Hirschmüller 2008); with five paths OpenCV's
  // disparities are biased by up to 0.2 px on sand. "bm": block matching, ten times as fast, holes.
  std::string method = "sgm";
  // Side (px, odd) of the window a matching cost is summed over. On sand 7 has 8 % less noise than
  // 5 and still keeps the outlines of pebbles; the paths bring the smoothness.
  int block_px = 7;
  // Costs of a disparity step of one and of more than one pixel, per pixel of the window. From
  // OpenCV's stereo_match sample.
  double small_step_cost = 8.0;
  double large_step_cost = 32.0;
  // The best cost must beat the second best elsewhere by this share (percent).
  int uniqueness_pct = 5;
  // Largest disagreement (px) between the disparities seen from left and from right.
  int left_right_px = 1;
  // Patches of connected disparities (neighbours within speckle_step_px) of fewer pixels than this
  // are dropped: false matches on weak texture reach some hundred; what is real is connected with
  // the ground it stands on.
  int speckle_size_px = 400;
  int speckle_step_px = 1;
  // Nearest depth (m) that is searched. The range is then narrowed to what each pair shows.
  double min_depth_m = 0.4;
  // One standard deviation of a disparity (px): measured 0.15 to 0.25 on textured ground.
  double disparity_sigma_px = 0.25;
  // Largest depth (m); 0: where the depth's sigma reaches max_depth_sigma_m.
  double max_range_m = 0.0;
  // 0.09 m: six metres for a baseline of 0.12 m and 840 px, where twice the sigma is the height
  // of a small rock.
  double max_depth_sigma_m = 0.09;

  OptionFields Fields();
  void Validate() const;  // throws UsageError

  // Largest depth for views of this focal length and baseline: z^2 / (f b) * sigma = its limit.
  double MaxDepth(double focal_px, double baseline_m) const;
};

}  // namespace rigmap
