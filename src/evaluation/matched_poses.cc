#include "evaluation/matched_poses.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

// Association is judged on seconds as double, as every reader of TUM files has them.
double Seconds(const TumPose& pose) {
  return static_cast<double>(static_cast<long double>(pose.stamp_ns) / 1e9L);
}

const TumPose& Nearest(const std::vector<TumPose>& estimate, const TumPose& truth, Tie tie) {
  const auto after =
      std::lower_bound(estimate.begin(), estimate.end(), truth,
                       [](const TumPose& a, const TumPose& b) { return Seconds(a) < Seconds(b); });
  if (after == estimate.begin()) return estimate.front();
  if (after == estimate.end()) return estimate.back();
  const double t = Seconds(truth);
  const double before_s = std::abs(Seconds(*(after - 1)) - t);
  const double after_s = std::abs(Seconds(*after) - t);
  const bool before = before_s < after_s || (before_s == after_s && tie == Tie::kEarlier);
  return before ? *(after - 1) : *after;
}

}  // namespace

std::vector<TumPose> InOrderOfTime(std::span<const TumPose> poses) {
  std::vector<TumPose> sorted(poses.begin(), poses.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const TumPose& a, const TumPose& b) { return a.stamp_ns < b.stamp_ns; });
  return sorted;
}

MatchedPoses MatchPoses(const std::vector<TumPose>& estimate, const std::vector<TumPose>& truth,
                        double max_dt_s, Tie tie) {
  MatchedPoses matched;
  if (estimate.empty()) return matched;
  for (const TumPose& true_pose : truth) {
    const TumPose& nearest = Nearest(estimate, true_pose, tie);
    if (!(std::abs(Seconds(nearest) - Seconds(true_pose)) <= max_dt_s)) continue;
    matched.estimate.push_back(nearest.world_from_body);
    matched.truth.push_back(true_pose.world_from_body);
  }
  return matched;
}

}  // namespace rigmap
