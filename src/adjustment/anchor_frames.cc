#include "adjustment/anchor_frames.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace rigmap {
namespace {

// Fewer leave a motion of six degrees of freedom to chance.
constexpr int kMinSharedPoints = 10;

int Root(std::vector<int>& anchors, int frame) {
  while (anchors[frame] != frame) frame = anchors[frame] = anchors[anchors[frame]];
  return frame;
}

// Points shared by every two groups.
std::map<std::pair<int, int>, int> SharedPoints(const std::vector<AdjustedPoint>& points,
                                                std::vector<int>& anchors) {
  std::map<std::pair<int, int>, int> shared;
  for (const AdjustedPoint& point : points) {
    std::set<int> groups;
    for (const PointObservation& observation : point.observations) {
      groups.insert(Root(anchors, observation.frame));
    }
    for (auto a = groups.begin(); a != groups.end(); ++a) {
      for (auto b = std::next(a); b != groups.end(); ++b) ++shared[{*a, *b}];
    }
  }
  return shared;
}

}  // namespace

std::vector<int> AnchorFrames(const std::vector<AdjustedPoint>& points, std::size_t frames) {
  std::vector<int> anchors(frames);
  std::iota(anchors.begin(), anchors.end(), 0);
  for (bool joined = true; joined;) {
    joined = false;
    for (const auto& [groups, count] : SharedPoints(points, anchors)) {
      const int a = Root(anchors, groups.first), b = Root(anchors, groups.second);
      if (count < kMinSharedPoints || a == b) continue;
      anchors[std::max(a, b)] = std::min(a, b);
      joined = true;
    }
  }
  for (std::size_t i = 0; i < frames; ++i) anchors[i] = Root(anchors, static_cast<int>(i));
  return anchors;
}

}  // namespace rigmap
