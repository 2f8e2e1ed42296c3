#include "adjustment/internal/datum_frames.h"

#include <algorithm>
#include <map>

#include "core/disjoint_sets.h"

namespace rigmap {
namespace {

// Twice what a motion of six degrees of freedom takes. That two frames show the same ground was
// proven before they were matched; fewer points, which may be what outliers have left, know too
// little of the motion to hold a group by.
constexpr int kMinSharedPoints = 6;

using PairCounts = std::map<std::pair<int, int>, int>;

// Points shared by every two groups.
PairCounts SharedPoints(const std::vector<AdjustedPoint>& points, DisjointSets& groups_of_frames) {
  PairCounts shared;
  std::vector<int> groups;
  for (const AdjustedPoint& point : points) {
    groups.clear();
    for (const PointObservation& observation : point.observations) {
      const int group = groups_of_frames.Root(observation.frame);
      if (groups.empty() || groups.back() != group) groups.push_back(group);
    }
    std::ranges::sort(groups);
    groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
    for (auto a = groups.begin(); a != groups.end(); ++a) {
      for (auto b = std::next(a); b != groups.end(); ++b) ++shared[{*a, *b}];
    }
  }
  return shared;
}

// Of frames that follow each other in a point: some of what they share, and nearly always enough.
PairCounts SharedWithNext(const std::vector<AdjustedPoint>& points) {
  PairCounts shared;
  for (const AdjustedPoint& point : points) {
    for (std::size_t i = 1; i < point.observations.size(); ++i) {
      const int from = point.observations[i - 1].frame, to = point.observations[i].frame;
      if (from != to) ++shared[std::minmax(from, to)];
    }
  }
  return shared;
}

// False where none were united.
bool Unite(const PairCounts& shared, DisjointSets& groups_of_frames) {
  bool united = false;
  for (const auto& [groups, count] : shared) {
    const int a = groups_of_frames.Root(groups.first), b = groups_of_frames.Root(groups.second);
    if (count < kMinSharedPoints || a == b) continue;
    groups_of_frames.Unite(std::min(a, b), std::max(a, b));
    united = true;
  }
  return united;
}

}  // namespace

std::vector<int> DatumFrames(const std::vector<AdjustedPoint>& points, std::size_t frames) {
  DisjointSets groups_of_frames(frames);
  // Most fall into their groups so, and are quickly counted then.
  Unite(SharedWithNext(points), groups_of_frames);
  while (Unite(SharedPoints(points, groups_of_frames), groups_of_frames)) {
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
    const auto group_of = [&](const PointObservation& o) { return datum_frames[o.frame]; };
    const int first = group_of(point.observations.front());
    if (std::ranges::all_of(
            point.observations, [=](int group) { return group == first; }, group_of)) {
      split.push_back(std::move(point));
      continue;
    }
    std::map<int, std::vector<PointObservation>> by_group;
    for (const PointObservation& o : point.observations) by_group[group_of(o)].push_back(o);
    for (auto& [group, observations] : by_group) {
      split.push_back({point.x, std::move(observations)});
    }
  }
  points = std::move(split);
}

}  // namespace rigmap
