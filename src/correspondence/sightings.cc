#include "correspondence/sightings.h"

#include <utility>

namespace rigmap {

std::vector<std::optional<Eigen::Vector2d>> PredictedPixels(
    const std::vector<std::optional<StereoPoint>>& points_of_a, const Rigid3& b_from_a,
    const StereoRig& rig) {
  std::vector<std::optional<Eigen::Vector2d>> pixels;
  for (const auto& point : points_of_a) {
    pixels.push_back(point ? Project(rig.left.camera, b_from_a * point->x_in_left) : std::nullopt);
  }
  return pixels;
}

std::vector<FeatureMatch> MatchedSightings::Agreeing(const StereoPose& pose) const {
  std::vector<FeatureMatch> agreeing;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (pose.inliers[i]) agreeing.push_back(matches[i]);
  }
  return agreeing;
}

MatchedSightings SightingsOf(std::span<const FeatureMatch> matches,
                             const std::vector<std::optional<StereoPoint>>& points_of_a,
                             const std::vector<Feature>& features_of_b, const StereoRig& rig) {
  MatchedSightings found;
  for (const FeatureMatch& match : matches) {
    const auto& point = points_of_a[match.a];
    const Feature& seen = features_of_b[match.b];
    const auto left = Undistort(rig.left.camera, seen.left);
    if (!point || !left) continue;
    found.sightings.push_back(
        {point->x_in_left, point->depth_sigma_m, *left,
         seen.right ? Undistort(rig.right.camera, *seen.right) : std::nullopt});
    found.matches.push_back(match);
  }
  return found;
}

}  // namespace rigmap
