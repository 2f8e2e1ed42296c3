#include "trajectory/lost_frames.h"

#include <algorithm>

namespace rigmap {

std::vector<int> LostFrames(const Odometry& odometry) {
  std::vector<int> lost;
  const int count = static_cast<int>(odometry.size());
  for (int first = 0, end = 0; first < count; first = std::max(end, first + 1)) {
    for (end = first; end < count && odometry[end].source == PoseSource::kPredicted; ++end) {
    }
    if (end < count && odometry[end].reference < first) continue;
    for (int i = first; i < end; ++i) {
      if (odometry[i].reference < i) lost.push_back(i);
    }
  }
  return lost;
}

}  // namespace rigmap
