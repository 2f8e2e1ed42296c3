#include "matching/matching_options.h"

namespace rigmap {

OptionFields VerificationOptions::Fields() {
  return {
      {"min_inliers", &min_inliers, "", AtLeast(6),
       "Fewer agreeing matches make no motion, as in odometry. With fewer than half of this number "
       "aligned the pair is dropped. Where the mapping adjusts odometric poses without the rig, it "
       "drops keyframes of which an image shows fewer points."},
  };
}

OptionFields MatchingOptions::Fields() {
  const OptionFields which = {
      {"neighbours", &neighbours, "", AtLeast(1).UpTo(50),
       "Keyframes before it that each keyframe is matched with. Sand loses half its matches with "
       "every frame; beyond four little is gained."},
      {"min_overlap", &min_overlap, "", MoreThan(0.0).UpTo(1.0),
       "A keyframe further back is tried where at least this share of its stereo points should be "
       "in view again."},
      {"max_revisits", &max_revisits, "", AtLeast(0),
       "At most so many keyframes further back are tried for each keyframe."},
      {"revisit_candidates", &revisit_candidates, "", AtLeast(0),
       "Keyframes that odometry need not know of: so many that are most alike in appearance are "
       "tried for each "
       "keyframe, with no prediction (0: none). On simulated loops one of the first three was "
       "right for all 18 keyframes that had a right one. Each costs some 5 ms."},
      {"min_revisit_inliers", &min_revisit_inliers, "", AtLeast(6),
       "Matches that must agree with one motion before such a keyframe counts as a loop closure, "
       "where "
       "a loop closure by another keyframe nearby tells of the same motion. Of 4200 pairs of "
       "frames "
       "from different simulated sands none reached six, of those of one straight drive that "
       "hardly share ground some ten: this is half as many again."},
      {"sure_revisit_inliers", &sure_revisit_inliers, "", AtLeast(6),
       "The same where no other loop closure tells of that motion; at least min_revisit_inliers. "
       "Three "
       "times what pairs reach that hardly share ground."},
      {"search_radius_px", &search_radius_px, "px", MoreThan(0.0),
       "Search around the predicted position, for frames next to each other."},
      {"max_search_radius_px", &max_search_radius_px, "px", MoreThan(0.0),
       "Largest search: the radius grows with the frames in between, each of which adds the error "
       "of a step of the odometry."},
  };
  const OptionFields verified = {
      {"keypoint_noise_px", &keypoint_noise_px, "px", MoreThan(0.0),
       "Sigma of a matched keypoint before its refinement, as in odometry."},
      {"disparity_noise_px", &disparity_noise_px, "px", MoreThan(0.0),
       "Sigma of a disparity, as in odometry."},
      {"max_sigmas", &max_sigmas, "sigmas", MoreThan(0.0),
       "A verified match may be off by so many sigmas under one motion of the rig."},
  };
  const OptionFields refined = {
      {"min_correlation", &min_correlation, "", MoreThan(0.0).Below(1.0),
       "Positions are refined by aligning each patch with its reference patch, from the first view "
       "of the point. A match that correlates less is dropped."},
      {"max_position_sigma_px", &max_position_sigma_px, "px", MoreThan(0.0),
       "A match whose refined position is less certain than this is dropped."},
      {"carry_below_share", &carry_below_share, "share", AtLeast(0.0).UpTo(1.0),
       "Where fewer of the points in view are found again (or fewer than six times min_inliers), "
       "the others are looked for where the motion shows them, as their ground will look there (0: "
       "never). Keyframes next to each other share a third to a half; over flat sand, half a metre "
       "on, a twentieth. From a fifth on nothing is gained."},
  };
  return JoinFields({which, verified, verification.Fields(), refined});
}

void MatchingOptions::RequireRelations() const {
  RequireOption(sure_revisit_inliers >= min_revisit_inliers, "matching.sure_revisit_inliers",
                "at least matching.min_revisit_inliers", sure_revisit_inliers);
}

}  // namespace rigmap
