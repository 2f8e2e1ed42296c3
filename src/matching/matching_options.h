// Options of the stage `matching`.
#pragma once

#include "core/options.h"

namespace rigmap {

// When a pair of frames counts as matched: also what the mapping asks of an image.
struct VerificationOptions {
  // Fewer agreeing matches make no motion; with fewer than half of them aligned the pair is
  // dropped.
  int min_inliers = 15;

  OptionFields Fields() { return {{"min_inliers", &min_inliers}}; }
  void Validate() const;  // throws UsageError
};

struct MatchingOptions {
  // Every keyframe is matched with so many before it. Sand leaves half its matches from one frame
  // to the next, so that beyond four little is gained.
  int neighbours = 4;
  // Earlier keyframes further back are tried where at least this share of a keyframe's stereo
  // points should be in view there again (revisits that odometry knows of), at most so many each.
  double min_overlap = 0.3;
  int max_revisits = 2;
  // Keyframes that odometry need not know of: so many that look most alike are tried for each, with
  // no prediction at all (0: none). On simulated loops one of the first three was right for all 18
  // keyframes that had a right one. Each costs some 5 ms.
  int revisit_candidates = 3;
  // Matches that must agree with one motion of the rig before such a keyframe counts as revisited:
  // the first number where a revisit by another keyframe nearby tells of the same motion, else the
  // second. Of 4200 pairs of frames from different simulated sands none reached six, of those of
  // one straight drive that hardly share ground some ten; the first is half as many again, the
  // second three times. Distant things alone reach 60: see FindRevisits.
  int min_revisit_inliers = 15;
  int sure_revisit_inliers = 30;
  // Matches are looked for so far (px) from where the odometry predicts them; grows with the
  // steps between the frames, each of which adds its own error.
  double search_radius_px = 8.0;
  double max_search_radius_px = 60.0;
  // One standard deviation (px) of a matched keypoint before refinement, and how many of them a
  // verified match may be off under one motion of the rig.
  double keypoint_noise_px = 0.3;
  double disparity_noise_px = 0.15;
  double max_sigmas = 4.0;
  VerificationOptions verification;
  // Positions are refined by aligning grey patches with the first view of a place; a patch that
  // correlates less, or whose position is less certain (px), is dropped from the match.
  double min_correlation = 0.8;
  double max_position_sigma_px = 0.15;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
