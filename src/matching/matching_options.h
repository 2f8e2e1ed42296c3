// Options of the stage `matching`.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in matching_options.cc.

// When a pair of frames counts as matched: also what the mapping asks of an image.
struct VerificationOptions {
  static constexpr const char* kSection = "matching";

  int min_inliers = 15;

  OptionFields Fields();
};

struct MatchingOptions {
  static constexpr const char* kSection = "matching";

  int neighbours = 4;
  double min_overlap = 0.3;
  int max_revisits = 2;
  int revisit_candidates = 3;
  int min_revisit_inliers = 15;
  int sure_revisit_inliers = 30;
  double search_radius_px = 8.0;
  double max_search_radius_px = 60.0;
  double keypoint_noise_px = 0.3;
  double disparity_noise_px = 0.15;
  double max_sigmas = 4.0;
  VerificationOptions verification;
  double min_correlation = 0.8;
  double max_position_sigma_px = 0.15;
  double carry_below_share = 0.1;

  OptionFields Fields();
  void RequireRelations() const;  // throws UsageError
};

}  // namespace rigmap
