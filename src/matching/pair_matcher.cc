#include "matching/internal/pair_matcher.h"

#include <algorithm>
#include <array>

#include "correspondence/sightings.h"

namespace rigmap {
VerifiedPair VerifyPair(const CandidatePair& pair, const Rigid3& predicted_b_from_a,
                        const MatchedFrame& a, const MatchedFrame& b, const StereoRig& rig,
                        const MatchingOptions& options) {
  const int steps = pair.b_from_a ? 1 : std::max(1, pair.b - pair.a);
  const double radius_px = std::min(options.max_search_radius_px, options.search_radius_px * steps);
  const auto matches =
      MatchFeatures(a.refinement.found, b.refinement.found,
                    PredictedPixels(a.points, predicted_b_from_a, rig), radius_px, {});
  const auto seen = SightingsOf(matches, a.points, b.refinement.found.features, rig);
  StereoPoseOptions pose_options;
  pose_options.noise_px = options.keypoint_noise_px;
  pose_options.max_sigmas = options.max_sigmas;
  pose_options.min_inliers = options.verification.min_inliers;
  const auto pose =
      EstimateStereoPose(seen.sightings, rig, std::array{predicted_b_from_a}, pose_options);
  return pose ? VerifiedPair{seen.Agreeing(*pose), pose} : VerifiedPair{};
}

}  // namespace rigmap
