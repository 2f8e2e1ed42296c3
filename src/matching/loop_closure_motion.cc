#include "matching/internal/loop_closure_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "correspondence/sightings.h"
#include "geometry/alignment.h"

namespace rigmap {
namespace {

struct PointPair {
  StereoPoint in_a, in_b;
  double variance_m2 = 0.0;  // of both depths together
};

// Whether two matches see their points equally far apart in both frames. Depths err along the
// lines of sight, which a distance between points feels in part: this is its upper bound.
bool Agree(const PointPair& one, const PointPair& other) {
  constexpr double kMaxSigmas = 2.0;
  constexpr double kMinTolerance_m = 0.01;
  const double difference = (one.in_a.x_in_left - other.in_a.x_in_left).norm() -
                            (one.in_b.x_in_left - other.in_b.x_in_left).norm();
  const double variance = one.variance_m2 + other.variance_m2;
  return difference * difference <=
         kMaxSigmas * kMaxSigmas * variance + kMinTolerance_m * kMinTolerance_m;
}

// Surest first.
std::vector<PointPair> PointPairs(std::span<const FeatureMatch> matches,
                                  const std::vector<std::optional<StereoPoint>>& of_a,
                                  const std::vector<std::optional<StereoPoint>>& of_b) {
  std::vector<PointPair> pairs;
  for (const FeatureMatch& match : matches) {
    const auto &in_a = of_a[match.a], &in_b = of_b[match.b];
    if (!in_a || !in_b) continue;
    const double sigma_a = in_a->depth_sigma_m, sigma_b = in_b->depth_sigma_m;
    pairs.push_back({*in_a, *in_b, sigma_a * sigma_a + sigma_b * sigma_b});
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const PointPair& one, const PointPair& other) {
    return one.variance_m2 < other.variance_m2;
  });
  return pairs;
}

// Of `members`, those that agree with at least half of them. Both in order.
std::vector<int> Core(const std::vector<PointPair>& pairs, const std::vector<int>& members) {
  std::vector<int> core;
  for (const int i : members) {
    const auto agreeing = std::count_if(members.begin(), members.end(),
                                        [&](int j) { return Agree(pairs[i], pairs[j]); });
    if (2 * agreeing >= static_cast<std::ptrdiff_t>(members.size())) core.push_back(i);
  }
  return core;
}

// From the surer half of the members.
std::optional<Rigid3> MotionOf(const std::vector<PointPair>& pairs,
                               const std::vector<int>& members) {
  constexpr std::size_t kMinPoints = 4;
  if (members.size() < kMinPoints) return std::nullopt;
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t m = 0; m < std::max(kMinPoints, members.size() / 2); ++m) {
    from.push_back(pairs[members[m]].in_a.x_in_left);
    to.push_back(pairs[members[m]].in_b.x_in_left);
  }
  const Sim3 motion = AlignPoints(from, to, false);
  return Rigid3{motion.rotation, motion.translation};
}

}  // namespace

std::vector<Rigid3> MotionsOfAgreeingMatches(std::span<const FeatureMatch> matches,
                                             const std::vector<std::optional<StereoPoint>>& of_a,
                                             const std::vector<std::optional<StereoPoint>>& of_b) {
  const std::vector<PointPair> pairs = PointPairs(matches, of_a, of_b);
  std::vector<std::vector<int>> agreeing(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < pairs.size(); ++j) {
      if (Agree(pairs[i], pairs[j])) agreeing[i].push_back(static_cast<int>(j));
    }
  }
  // Far points are so unsure that they agree with anything.
  std::vector<int> by_agreement((pairs.size() + 1) / 2);
  std::iota(by_agreement.begin(), by_agreement.end(), 0);
  std::stable_sort(by_agreement.begin(), by_agreement.end(),
                   [&](int i, int j) { return agreeing[i].size() > agreeing[j].size(); });
  // The match that agrees with most may be a wrong one in their midst, hardly so five.
  constexpr std::size_t kSeeds = 5;
  std::vector<Rigid3> motions;
  for (std::size_t s = 0; s < std::min(kSeeds, by_agreement.size()); ++s) {
    const auto motion = MotionOf(pairs, Core(pairs, agreeing[by_agreement[s]]));
    if (motion) motions.push_back(*motion);
  }
  return motions;
}

std::optional<StereoPose> MotionWithoutPrediction(const SearchedFrame& a, const SearchedFrame& b,
                                                  const StereoRig& rig,
                                                  const MatchingOptions& options) {
  const auto matches = MatchFeatures(a.features, b.features, a.groups, b.groups, {});
  const auto guesses = MotionsOfAgreeingMatches(matches, a.points, b.points);
  const auto seen = SightingsOf(matches, a.points, b.features.features, rig);
  StereoPoseOptions pose_options;
  pose_options.noise_px = options.keypoint_noise_px;
  pose_options.max_sigmas = options.max_sigmas;
  pose_options.min_inliers = options.min_revisit_inliers;
  // Three points at random would hardly ever be three right ones.
  pose_options.max_samples = 0;
  return EstimateStereoPose(seen.sightings, rig, guesses, pose_options);
}

}  // namespace rigmap
