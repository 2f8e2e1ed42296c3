#include "correspondence/sightings.h"

#include <algorithm>
#include <utility>

#include "core/statistics.h"

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

double MetresSigma(const std::vector<std::optional<StereoPoint>>& points_of_a,
                   std::span<const FeatureMatch> matches) {
  // Near are so many points whose depth the disparity tells to such a share.
  constexpr int kLeastNear = 6;
  constexpr double kNear = 0.1;
  std::vector<double> shares;
  for (const FeatureMatch& match : matches) {
    if (const auto& point = points_of_a[match.a]) {
      shares.push_back(point->depth_sigma_m / point->x_in_left.norm());
    }
  }
  const auto near = std::ranges::count_if(shares, [](double share) { return share <= kNear; });
  return near >= kLeastNear || shares.empty() ? 0.0 : Median(std::move(shares));
}

}  // namespace rigmap
