// Estimated and true poses of the same moments.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "export/tum.h"

namespace rigmap {

inline constexpr std::size_t kMinMatches = 3;  // fewer determine no alignment

struct MatchedPoses {
  std::vector<Rigid3> estimate, truth;  // world_from_body of either world, in parallel

  std::size_t size() const { return truth.size(); }
};

// Which of two estimated poses that are equally near in time to a true one.
enum class Tie { kEarlier, kLater };

std::vector<TumPose> InOrderOfTime(std::span<const TumPose> poses);

// Each true pose with the estimated one nearest in time, if within max_dt_s. An estimated pose may
// serve several true ones. Both lists in order of time.
MatchedPoses MatchPoses(const std::vector<TumPose>& estimate, const std::vector<TumPose>& truth,
                        double max_dt_s, Tie tie);

}  // namespace rigmap
