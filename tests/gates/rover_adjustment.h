// The synthetic rover as an adjustment that left poses, points and rig at the truth.
#pragma once

#include <algorithm>

#include "scene/adjustment.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {

inline Adjustment RoverAdjustment(const SyntheticRover& rover) {
  Adjustment adjustment;
  adjustment.rig = rover.rig;
  adjustment.world_from_left.assign(rover.world_from_left.begin(), rover.world_from_left.end());
  for (const Eigen::Vector3d& x : rover.points) adjustment.points.push_back({x, {}});
  for (std::size_t frame = 0; frame < rover.frames.size(); ++frame) {
    const auto& features = rover.frames[frame].features;
    for (std::size_t i = 0; i < features.size(); ++i) {
      auto& seen = adjustment.points[rover.point_of_feature[frame][i]].observations;
      const int at = static_cast<int>(frame), feature = static_cast<int>(i);
      seen.push_back({at, feature, Eye::kLeft, features[i].left});
      if (features[i].right) seen.push_back({at, feature, Eye::kRight, *features[i].right});
    }
  }
  std::erase_if(adjustment.points, [](const AdjustedPoint& point) {
    return point.observations.empty() ||
           point.observations.front().frame == point.observations.back().frame;
  });
  return adjustment;
}

// All positions, but for the rig, by a factor.
inline void Stretch(double factor, Adjustment& adjustment) {
  for (auto& pose : adjustment.world_from_left) pose->translation *= factor;
  for (AdjustedPoint& point : adjustment.points) point.x *= factor;
}

}  // namespace rigmap
