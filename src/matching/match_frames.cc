#include "matching/match_frames.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>

#include "correspondence/feature_matching.h"
#include "correspondence/stereo_points.h"
#include "correspondence/stereo_pose.h"
#include "matching/frame_window.h"
#include "matching/pair_selection.h"

namespace rigmap {
namespace {

std::vector<Eigen::Vector3d> SamplePoints(const std::vector<std::optional<StereoPoint>>& points) {
  constexpr std::size_t kSamples = 100;
  std::vector<Eigen::Vector3d> present, sample;
  for (const auto& point : points) {
    if (point) present.push_back(point->x_in_left);
  }
  const std::size_t step = std::max<std::size_t>(1, present.size() / kSamples);
  for (std::size_t i = 0; i < present.size(); i += step) sample.push_back(present[i]);
  return sample;
}

class PairMatcher {
 public:
  PairMatcher(const Odometry& odometry, const StereoRig& rig, const MatchingOptions& options)
      : odometry_(odometry), rig_(rig), options_(options) {}

  // Matches whose stereo point in a agrees with both eyes of b under one motion.
  std::vector<FeatureMatch> Verified(const CandidatePair& pair, const MatchedFrame& a,
                                     const MatchedFrame& b) const {
    const Rigid3 b_from_a =
        odometry_[pair.b].world_from_left.Inverse() * odometry_[pair.a].world_from_left;
    std::vector<std::optional<Eigen::Vector2d>> predicted;
    for (const auto& point : a.points) {
      predicted.push_back(point ? Project(rig_.left.camera, b_from_a * point->x_in_left)
                                : std::nullopt);
    }
    const double radius_px = std::min(options_.max_search_radius_px,
                                      options_.search_radius_px * std::max(1, pair.b - pair.a));
    const auto matches =
        MatchFeatures(a.anchored.found, b.anchored.found, predicted, radius_px, {});
    return AgreeingWithOneMotion(matches, b_from_a, a, b);
  }

 private:
  std::vector<FeatureMatch> AgreeingWithOneMotion(const std::vector<FeatureMatch>& matches,
                                                  const Rigid3& b_from_a, const MatchedFrame& a,
                                                  const MatchedFrame& b) const {
    std::vector<PointSighting> sightings;
    std::vector<FeatureMatch> used;
    for (const FeatureMatch& match : matches) {
      const auto& point = a.points[match.a];
      const Feature& seen = b.anchored.found.features[match.b];
      const auto left = Undistort(rig_.left.camera, seen.left);
      if (!point || !left) continue;
      sightings.push_back({point->x_in_left, point->depth_sigma_m, *left,
                           seen.right ? Undistort(rig_.right.camera, *seen.right) : std::nullopt});
      used.push_back(match);
    }
    StereoPoseOptions pose_options;
    pose_options.noise_px = options_.keypoint_noise_px;
    pose_options.max_sigmas = options_.max_sigmas;
    pose_options.min_inliers = options_.min_inliers;
    const auto pose = EstimateStereoPose(sightings, rig_, std::array{b_from_a}, pose_options);
    std::vector<FeatureMatch> kept;
    for (std::size_t i = 0; pose && i < used.size(); ++i) {
      if (pose->inliers[i]) kept.push_back(used[i]);
    }
    return kept;
  }

  const Odometry& odometry_;
  const StereoRig& rig_;
  const MatchingOptions& options_;
};

// Expected growth of a patch from a to b: the nearer, the larger.
double Growth(const StereoPoint& in_a, const Rigid3& b_from_a) {
  const double depth_in_b = (b_from_a * in_a.x_in_left).z();
  return std::clamp(in_a.x_in_left.z() / std::max(depth_in_b, 1e-6), 0.5, 2.0);
}

// Moves features of b onto their place in a where they have not been aligned yet; drops matches
// whose patches disagree. A feature already aligned with another view is taken as it is.
FramePair Refine(const CandidatePair& pair, const std::vector<FeatureMatch>& matches,
                 const Odometry& odometry, FrameWindow& window, const MatchingOptions& options) {
  // Align the frame that was not matched with others before, which is the one that is no keyframe
  // or else the later one.
  const bool backwards = !odometry[pair.a].keyframe;
  const int fixed_frame = backwards ? pair.b : pair.a, moving_frame = backwards ? pair.a : pair.b;
  MatchedFrame &fixed = window.At(fixed_frame), &moving = window.At(moving_frame);
  const Rigid3 moving_from_fixed =
      odometry[moving_frame].world_from_left.Inverse() * odometry[fixed_frame].world_from_left;
  FramePair result{pair.a, pair.b, {}};
  for (const FeatureMatch& match : matches) {
    const int in_fixed = backwards ? match.b : match.a, in_moving = backwards ? match.a : match.b;
    const auto& point = fixed.points[in_fixed];
    const double growth = point ? Growth(*point, moving_from_fixed) : 1.0;
    if (!moving.anchored.aligned[in_moving] &&
        !AlignWithAnchor(fixed.anchored, in_fixed, moving.anchored, in_moving, growth, options)) {
      continue;
    }
    result.matches.emplace_back(match.a, match.b);
  }
  return result;
}

}  // namespace

Correspondences MatchFrames(const Odometry& odometry, const MatchingFeatures& features,
                            const StereoRig& rig, const MatchingOptions& options) {
  std::vector<std::vector<Eigen::Vector3d>> sample_points(odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (!odometry[i].keyframe) continue;
    sample_points[i] = SamplePoints(TriangulateFeatures(features(static_cast<int>(i)).features, rig,
                                                        options.disparity_noise_px));
  }
  // Pairs come in order of time, so that a frame's neighbours and revisits are all that is held.
  const int held = options.neighbours + options.max_revisits + 2;
  FrameWindow window(features, rig, options.disparity_noise_px, static_cast<std::size_t>(held));
  const PairMatcher matcher(odometry, rig, options);
  Correspondences result;
  for (const CandidatePair& pair : SelectPairs(odometry, sample_points, rig, options)) {
    const auto verified = matcher.Verified(pair, window.At(pair.a), window.At(pair.b));
    FramePair refined = Refine(pair, verified, odometry, window, options);
    spdlog::info("{} {}: {} verified, {} aligned", pair.a, pair.b, verified.size(),
                 refined.matches.size());
    if (static_cast<int>(refined.matches.size()) >= options.min_inliers) {
      result.pairs.push_back(std::move(refined));
    }
  }
  result.features = window.Finish(static_cast<int>(odometry.size()));
  return result;
}

}  // namespace rigmap
