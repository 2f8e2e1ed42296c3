#include "matching/internal/pair_matcher.h"

#include <algorithm>
#include <array>

#include "correspondence/sightings.h"

namespace rigmap {

StereoPoseOptions PairPoseOptions(const MatchingOptions& options) {
  return {.noise_px = options.keypoint_noise_px,
          .max_sigmas = options.max_sigmas,
          .min_inliers = options.verification.min_inliers};
}

VerifiedPair VerifyPair(const CandidatePair& pair, const Rigid3& predicted_b_from_a,
                        const MatchedFrame& a, const MatchedFrame& b, const StereoRig& rig,
                        const MatchingOptions& options) {
  const int steps = pair.b_from_a ? 1 : std::max(1, pair.b - pair.a);
  const double radius_px = std::min(options.max_search_radius_px, options.search_radius_px * steps);
  const auto matches =
      MatchFeatures(a.refinement.found, b.refinement.found,
                    PredictedPixels(a.points, predicted_b_from_a, rig), radius_px, {});
  const auto seen = SightingsOf(matches, a.points, b.refinement.found.features, rig);
  const auto pose = EstimateStereoPose(seen.sightings, rig, std::array{predicted_b_from_a},
                                       PairPoseOptions(options));
  return pose ? VerifiedPair{seen.Agreeing(*pose), pose} : VerifiedPair{};
}

}  // namespace rigmap
