// Options of the stage `features`.
#pragma once

#include "core/options.h"

namespace rigmap {

struct FeatureOptions {
  // Keypoints kept per left image, spread evenly. 1500 leave some 600 matches to a neighbour on
  // sand, five times what a pose needs; more cost time everywhere after.
  int max_keypoints = 1500;
  // Images larger than this (megapixels) are searched for keypoints at half resolution; positions
  // are refined at full resolution whatever this says. Half costs a quarter of the time.
  double half_resolution_above_mpx = 0.6;
  // SIFT's own threshold on contrast, in shares of full range. Low: on sand the spread over the
  // image matters more than strength.
  double contrast_threshold = 0.008;
  // The same where an image has fewer than max_keypoints with the first: half a grey level, below
  // which there is only rounding. Dull sand then gives six times as many.
  double faint_contrast_threshold = 0.002;
  double edge_threshold = 10.0;
  // Nearest depth searched for stereo partners, in baselines. At 5 the eyes see a patch under
  // angles that differ by 11 degrees.
  double min_depth_baselines = 5.0;
  // Half height (px) of the band around the epipolar line that is searched, so that a rig whose
  // rows are off is noticed (gate epipolar_px) rather than starved of matches.
  double epipolar_band_px = 4.0;
  // A partner must correlate at least so well, and its second best place less by the margin.
  double min_correlation = 0.8;
  double min_uniqueness = 0.05;
  // Partners further from the line than this many robust sigmas of the frame's own epipolar errors
  // (and 0.5 px at least) are rejected.
  double max_epipolar_sigmas = 4.0;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
