// Matches of two frames, refined to the first view of each ground point.
#pragma once

#include <utility>
#include <vector>

#include "correspondence/feature_matching.h"
#include "matching/frame_window.h"
#include "matching/matching_options.h"
#include "scene/correspondences.h"
#include "scene/odometry.h"
#include "scene/rig.h"
#include "scene/sampled_features.h"

namespace rigmap {

class PairRefiner {
 public:
  // Two frames that are held, a < b, and the motion between them.
  struct Pair {
    int a = 0, b = 0;
    MatchedFrame &in_a, &in_b;
    Rigid3 b_from_a;
  };

  // All must outlive this. Without `sample` nothing is carried.
  PairRefiner(const Odometry& odometry, const StereoRig& rig, const MatchingOptions& options,
              const FeatureSampler& sample)
      : odometry_(odometry), rig_(rig), options_(options), sample_(sample) {}

  // Aligns features of the one frame with those of the other where they have not been aligned yet;
  // drops matches whose patches disagree. A feature already aligned with another view is taken as
  // it is. `returned`: the ground was out of view in between.
  FramePair Refine(const Pair& pair, const std::vector<FeatureMatch>& matches, bool returned) const;

  // Where few of the points that both frames have in view were found again (carry_below_share): the
  // others are looked for where the motion shows them, and become features there if their patches
  // agree, and both eyes with the motion. Some pixels from what has been aligned already, lest the
  // same ground count twice.
  void CarryMore(const Pair& pair, FramePair& refined) const;

 private:
  // Which of the pair holds its reference patches, and which is aligned with them.
  struct Sides;
  // Features of a frame, and which ones of the frame that is held they are to show.
  struct Carried {
    std::vector<int> of_fixed;
    FrameFeatures features;
  };

  Sides SidesOf(const Pair& pair) const;
  ExpectedView Expected(const Sides& sides, int feature, bool turned) const;
  Carried SampleThere(const Sides& sides, const FramePair& refined) const;
  bool IsFew(std::size_t matches, const Sides& sides) const;
  std::vector<FeatureMatch> Agreeing(const Sides& sides, const FramePair& refined,
                                     const std::vector<int>& of_fixed,
                                     const std::vector<char>& is_aligned,
                                     const FeatureRefinement& there) const;

  const Odometry& odometry_;
  const StereoRig& rig_;
  const MatchingOptions& options_;
  const FeatureSampler& sample_;
};

}  // namespace rigmap
