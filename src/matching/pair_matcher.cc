#include "matching/pair_matcher.h"

#include <algorithm>
#include <array>

#include "matching/revisit_motion.h"

namespace rigmap {
namespace {

VerifiedPair AgreeingWithOneMotion(const std::vector<FeatureMatch>& matches,
                                   const Rigid3& predicted_b_from_a, const MatchedFrame& a,
                                   const MatchedFrame& b, const StereoRig& rig,
                                   const MatchingOptions& options) {
  std::vector<FeatureMatch> used;
  const auto sightings = Sightings(matches, a.points, b.anchored.found.features, rig, used);
  StereoPoseOptions pose_options;
  pose_options.noise_px = options.keypoint_noise_px;
  pose_options.max_sigmas = options.max_sigmas;
  pose_options.min_inliers = options.min_inliers;
  VerifiedPair result;
  result.b_from_a =
      EstimateStereoPose(sightings, rig, std::array{predicted_b_from_a}, pose_options);
  for (std::size_t i = 0; result.b_from_a && i < used.size(); ++i) {
    if (result.b_from_a->inliers[i]) result.matches.push_back(used[i]);
  }
  return result;
}

}  // namespace

VerifiedPair VerifyPair(const CandidatePair& pair, const Rigid3& predicted_b_from_a,
                        const MatchedFrame& a, const MatchedFrame& b, const StereoRig& rig,
                        const MatchingOptions& options) {
  std::vector<std::optional<Eigen::Vector2d>> predicted;
  for (const auto& point : a.points) {
    predicted.push_back(point ? Project(rig.left.camera, predicted_b_from_a * point->x_in_left)
                              : std::nullopt);
  }
  const int steps = pair.b_from_a ? 1 : std::max(1, pair.b - pair.a);
  const double radius_px = std::min(options.max_search_radius_px, options.search_radius_px * steps);
  const auto matches = MatchFeatures(a.anchored.found, b.anchored.found, predicted, radius_px, {});
  return AgreeingWithOneMotion(matches, predicted_b_from_a, a, b, rig, options);
}

}  // namespace rigmap
