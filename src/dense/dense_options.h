// How depth is got from a pair of rectified images.
#pragma once

#include <string>

#include "core/options.h"

namespace rigmap {

struct DenseOptions {
  // "sgm": semi-global matching over eight paths (Hirschmüller 2008); with five paths OpenCV's
  // disparities are biased by up to 0.2 px on sand. "bm": block matching, ten times as fast, holes.
  std::string method = "sgm";
  // Side (px, odd) of the window a matching cost is summed over. With 7 twice as many false matches
  // are left on sand as with 5, with 3 more noise; the paths bring the smoothness.
  int block_px = 5;
  // Costs of a disparity step of one and of more than one pixel, per pixel of the window. From
  // OpenCV's stereo_match sample.
  double small_step_cost = 8.0;
  double large_step_cost = 32.0;
  // The best cost must beat the second best elsewhere by this share (percent). With 5, 0.4 to 0.6 %
  // of disparities on sand are off by more than 1.5 px, with 10 a tenth of that, 0.4 % fewer being
  // known.
  int uniqueness_pct = 10;
  // Largest disagreement (px) between the disparities seen from left and from right.
  int left_right_px = 1;
  // Patches of connected disparities (neighbours within speckle_step_px) of fewer pixels than this
  // are dropped: false matches on weak texture reach some hundred; what is real is connected with
  // the ground it stands on.
  int speckle_size_px = 400;
  int speckle_step_px = 1;
  // Sides (px, odd) of the window in which both views are brought to agree below the pixel, and of
  // that in which disparities of one surface are averaged; 1: not at all.
  int refinement_px = 9;
  int smoothing_px = 7;
  // What the refinement's own sigma is multiplied with, and what it never falls below (px).
  // Neighbours share noise, since views are resampled; against true depths 1.6 to 2.3 and 0.05.
  double refined_sigma_factor = 2.0;
  double least_sigma_px = 0.05;
  // Nearest depth (m) that is searched. The range is then narrowed to what each pair shows.
  double min_depth_m = 0.4;
  // One standard deviation of a disparity as matched (px) on textured ground: 0.12 to 0.25. It
  // decides the range; each pixel has a sigma of its own besides.
  double disparity_sigma_px = 0.25;
  // Largest depth (m); 0: where the depth's sigma reaches max_depth_sigma_m.
  double max_range_m = 0.0;
  // 0.09 m: six metres for a baseline of 0.12 m and 840 px, where twice the sigma is the height of
  // a small rock. Pixels whose own sigma is larger are left out.
  double max_depth_sigma_m = 0.09;

  OptionFields Fields();
  void Validate() const;  // throws UsageError

  // Largest depth for views of this focal length and baseline: z^2 / (f b) * sigma = its limit.
  double MaxDepth(double focal_px, double baseline_m) const;
};

}  // namespace rigmap
