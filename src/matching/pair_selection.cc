#include "matching/internal/pair_selection.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rigmap {
namespace {

// Share of the points that the other frame has in view.
double Overlap(const std::vector<Eigen::Vector3d>& points, const Rigid3& other_from_own,
               const Camera& camera) {
  if (points.empty()) return 0.0;
  const auto seen = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& x) {
    const auto pixel = Project(camera, other_from_own * x);
    return pixel && camera.Contains(*pixel);
  });
  return static_cast<double>(seen) / static_cast<double>(points.size());
}

// Keyframes before the k-th that see most of the same ground, beyond its neighbours; best first.
std::vector<int> ClosuresOf(int k, const std::vector<int>& keyframes, const Odometry& odometry,
                            const std::vector<std::vector<Eigen::Vector3d>>& sample_points,
                            const Camera& camera, const MatchingOptions& options) {
  const int b = keyframes[k];
  std::vector<std::pair<double, int>> candidates;
  for (int earlier = 0; earlier < k - options.neighbours; ++earlier) {
    const int a = keyframes[earlier];
    const Rigid3 a_from_b = odometry[a].world_from_left.Inverse() * odometry[b].world_from_left;
    const double overlap = Overlap(sample_points[b], a_from_b, camera);
    if (overlap >= options.min_overlap) candidates.emplace_back(-overlap, a);
  }
  std::ranges::sort(candidates);
  candidates.resize(std::min<std::size_t>(candidates.size(), std::max(0, options.max_revisits)));
  std::vector<int> closures;
  for (const auto& [overlap, a] : candidates) closures.push_back(a);
  return closures;
}

}  // namespace

std::vector<int> Keyframes(const Odometry& odometry) {
  std::vector<int> keyframes;
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (odometry[i].keyframe) keyframes.push_back(static_cast<int>(i));
  }
  return keyframes;
}

std::vector<int> LoopCandidatesBefore(
    const std::vector<int>& keyframes, const Odometry& odometry,
    const std::vector<std::vector<Eigen::Vector3d>>& sample_points, const StereoRig& rig,
    const MatchingOptions& options) {
  // Half of what makes a pair worth matching.
  const double left_overlap = 0.5 * options.min_overlap;
  std::vector<int> loop_candidates;
  for (int k = 0; k < static_cast<int>(keyframes.size()); ++k) {
    const int b = keyframes[k];
    int earlier = std::max(0, k - options.neighbours);
    for (; earlier > 0; --earlier) {
      const int a = keyframes[earlier - 1];
      const Rigid3 a_from_b = odometry[a].world_from_left.Inverse() * odometry[b].world_from_left;
      const double seen_before = Overlap(sample_points[b], a_from_b, rig.left.camera);
      const double still_seen = Overlap(sample_points[a], a_from_b.Inverse(), rig.left.camera);
      if (std::min(seen_before, still_seen) < left_overlap) break;
    }
    loop_candidates.push_back(earlier);
  }
  return loop_candidates;
}

std::vector<CandidatePair> SelectPairs(
    const Odometry& odometry, const std::vector<std::vector<Eigen::Vector3d>>& sample_points,
    const StereoRig& rig, const MatchingOptions& options) {
  const std::vector<int> keyframes = Keyframes(odometry);
  std::vector<std::vector<int>> closures(keyframes.size());
  tbb::parallel_for(std::size_t{0}, keyframes.size(), [&](std::size_t k) {
    closures[k] = ClosuresOf(static_cast<int>(k), keyframes, odometry, sample_points,
                             rig.left.camera, options);
  });
  std::vector<CandidatePair> pairs;
  for (int k = 0; k < static_cast<int>(keyframes.size()); ++k) {
    const int b = keyframes[k];
    for (int earlier = k - 1; earlier >= std::max(0, k - options.neighbours); --earlier) {
      pairs.push_back({keyframes[earlier], b, false});
    }
    for (const int a : closures[k]) pairs.push_back({a, b, true});
    for (int frame = k > 0 ? keyframes[k - 1] + 1 : 0; frame < b; ++frame) {
      if (k > 0) pairs.push_back({keyframes[k - 1], frame, false});
      pairs.push_back({frame, b, false});
    }
  }
  for (int frame = keyframes.empty() ? 0 : keyframes.back() + 1;
       frame < static_cast<int>(odometry.size()) && !keyframes.empty(); ++frame) {
    pairs.push_back({keyframes.back(), frame, false});
  }
  return pairs;
}

void AddFoundLoopClosures(const std::vector<LoopClosure>& found,
                          std::vector<CandidatePair>& pairs) {
  for (const LoopClosure& loop_closure : found) {
    const auto known = std::find_if(pairs.begin(), pairs.end(), [&](const CandidatePair& pair) {
      return pair.a == loop_closure.a && pair.b == loop_closure.b;
    });
    if (known != pairs.end()) {
      known->b_from_a = loop_closure.b_from_a;
      continue;
    }
    const auto first = std::find_if(pairs.begin(), pairs.end(), [&](const CandidatePair& pair) {
      return pair.b == loop_closure.b;
    });
    const auto end = std::find_if(
        first, pairs.end(), [&](const CandidatePair& pair) { return pair.b != loop_closure.b; });
    pairs.insert(end, {loop_closure.a, loop_closure.b, true, loop_closure.b_from_a});
  }
}

}  // namespace rigmap
