#include "adjustment/internal/datum_frames.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/disjoint_sets.h"

namespace rigmap {
namespace {

// Twice what a motion of six degrees of freedom takes. That two frames show the same ground was
// proven before they were matched; fewer points, which may be what outliers have left, know too
// little of the motion to hold a group by.
constexpr int kMinSharedPoints = 6;

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

void SplitBetweenGroups(std::size_t frames, std::vector<AdjustedPoint>& points) {
  const std::vector<int> datum_frames = DatumFrames(points, frames);
  std::vector<AdjustedPoint> split;
  for (AdjustedPoint& point : points) {
    std::map<int, std::vector<PointObservation>> by_group;
    for (const PointObservation& o : point.observations) {
      by_group[datum_frames[static_cast<std::size_t>(o.frame)]].push_back(o);
    }
    if (by_group.size() == 1) {
      split.push_back(std::move(point));
      continue;
    }
    for (auto& [group, observations] : by_group) {
      split.push_back({point.x, std::move(observations)});
    }
  }
  points = std::move(split);
}

}  // namespace rigmap
