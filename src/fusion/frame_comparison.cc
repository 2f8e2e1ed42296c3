#include "fusion/internal/frame_comparison.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rigmap {
namespace {

Eigen::Vector3d Forward(const Rigid3& world_from_left) {
  return world_from_left.rotation * Eigen::Vector3d::UnitZ();
}

}  // namespace

bool FaceAlike(const Rigid3& a, const Rigid3& b, const FusionOptions& options) {
  const double least_cosine = std::cos(options.max_neighbour_angle_deg * std::numbers::pi / 180.0);
  return Forward(a).dot(Forward(b)) >= least_cosine;
}

FrameComparison CompareWith(std::size_t reference, std::span<const Rigid3> world_from_left,
                            const FusionOptions& options) {
  // Ranks of the frames ahead, beyond the near ones: 0, 1, 3, 6, 10, 16, 25, ...
  constexpr double kGrowth = 1.5;
  const Rigid3& own = world_from_left[reference];
  const Eigen::Vector3d own_forward = Forward(own), own_position = own.translation;
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < world_from_left.size(); ++i) {
    if (i == reference || !FaceAlike(own, world_from_left[i], options)) continue;
    by_distance.emplace_back((world_from_left[i].translation - own_position).norm(), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  FrameComparison found;
  int rank = 0, next = 0;
  for (const auto& [distance_m, i] : by_distance) {
    if (found.near.size() < static_cast<std::size_t>(options.neighbours)) {
      found.near.push_back(i);
      continue;
    }
    const bool is_asked_for = found.ahead.size() < static_cast<std::size_t>(options.ahead);
    if (found.further.size() < kFurther) {
      found.further.push_back(i);
    } else if (!is_asked_for) {
      break;
    }
    if (!is_asked_for) continue;
    if ((world_from_left[i].translation - own_position).dot(own_forward) <= 0.0) continue;
    if (rank++ < next) continue;
    found.ahead.push_back(i);
    next = static_cast<int>(std::floor(kGrowth * rank));
  }
  return found;
}

}  // namespace rigmap
