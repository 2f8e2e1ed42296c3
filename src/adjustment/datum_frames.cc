#include "adjustment/internal/datum_frames.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/disjoint_sets.h"

namespace rigmap {
namespace {

// Fewer leave a motion of six degrees of freedom to chance.
constexpr int kMinSharedPoints = 10;

// Points shared by every two groups.
std::map<std::pair<int, int>, int> SharedPoints(const std::vector<AdjustedPoint>& points,
                                                DisjointSets& groups_of_frames) {
  std::map<std::pair<int, int>, int> shared;
  for (const AdjustedPoint& point : points) {
    std::set<int> groups;
    for (const PointObservation& observation : point.observations) {
      groups.insert(groups_of_frames.Root(observation.frame));
    }
    for (auto a = groups.begin(); a != groups.end(); ++a) {
      for (auto b = std::next(a); b != groups.end(); ++b) ++shared[{*a, *b}];
    }
  }
  return shared;
}

}  // namespace

std::vector<int> DatumFrames(const std::vector<AdjustedPoint>& points, std::size_t frames) {
  DisjointSets groups_of_frames(frames);
  for (bool joined = true; joined;) {
    joined = false;
    for (const auto& [groups, count] : SharedPoints(points, groups_of_frames)) {
      const int a = groups_of_frames.Root(groups.first), b = groups_of_frames.Root(groups.second);
      if (count < kMinSharedPoints || a == b) continue;
      groups_of_frames.Unite(std::min(a, b), std::max(a, b));
      joined = true;
    }
  }
  std::vector<int> datum_frames(frames);
  for (std::size_t i = 0; i < frames; ++i)
    datum_frames[i] = groups_of_frames.Root(static_cast<int>(i));
  return datum_frames;
}

}  // namespace rigmap
