// Matches of two stereo frames as the estimate of their motion wants them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "correspondence/feature_matching.h"
#include "correspondence/stereo_points.h"
#include "correspondence/stereo_pose.h"

namespace rigmap {

// Where the left eye of frame b would see the stereo points of frame a; nothing for features
// without a point and points behind it.
std::vector<std::optional<Eigen::Vector2d>> PredictedPixels(
    const std::vector<std::optional<StereoPoint>>& points_of_a, const Rigid3& b_from_a,
    const StereoRig& rig);

struct MatchedSightings {
  std::vector<FeatureMatch> matches;     // those whose feature of a has a point, and of b a ray
  std::vector<PointSighting> sightings;  // one of each

  // The matches that the pose's inliers are of.
  std::vector<FeatureMatch> Agreeing(const StereoPose& pose) const;
};

// Where frame b sees the stereo points of frame a that its features are matched with.
MatchedSightings SightingsOf(std::span<const FeatureMatch> matches,
                             const std::vector<std::optional<StereoPoint>>& points_of_a,
                             const std::vector<Feature>& features_of_b, const StereoRig& rig);

}  // namespace rigmap
