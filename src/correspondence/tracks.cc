#include "correspondence/tracks.h"

#include <algorithm>
#include <map>

#include "core/disjoint_sets.h"

namespace rigmap {
namespace {

std::size_t FeatureCount(const std::vector<std::vector<Feature>>& features) {
  std::size_t count = 0;
  for (const auto& frame : features) count += frame.size();
  return count;
}

// Sets of features that hold at most one feature per frame.
class TrackSets {
 public:
  explicit TrackSets(const std::vector<std::vector<Feature>>& features)
      : sets_(FeatureCount(features)) {
    for (const auto& frame : features) {
      first_.push_back(static_cast<int>(members_.size()));
      for (std::size_t i = 0; i < frame.size(); ++i) {
        members_.push_back({{static_cast<int>(first_.size()) - 1, static_cast<int>(i)}});
      }
    }
  }

  int IdOf(const FeatureRef& ref) const { return first_[ref.frame] + ref.feature; }

  void Join(const FeatureRef& a, const FeatureRef& b) {
    int root_a = sets_.Root(IdOf(a)), root_b = sets_.Root(IdOf(b));
    if (root_a == root_b) return;
    if (members_[root_a].size() < members_[root_b].size()) std::swap(root_a, root_b);
    Track joined;
    std::merge(members_[root_a].begin(), members_[root_a].end(), members_[root_b].begin(),
               members_[root_b].end(), std::back_inserter(joined));
    const auto same_frame = [](const FeatureRef& x, const FeatureRef& y) {
      return x.frame == y.frame;
    };
    if (std::adjacent_find(joined.begin(), joined.end(), same_frame) != joined.end()) return;
    sets_.Unite(root_a, root_b);
    members_[root_a] = std::move(joined);
    members_[root_b] = {};
  }

  const std::vector<Track>& Members() const { return members_; }

 private:
  std::vector<int> first_;  // id of each frame's first feature
  DisjointSets sets_;
  std::vector<Track> members_;  // of each root, in order of frames
};

}  // namespace

std::vector<Track> BuildTracks(const Correspondences& correspondences, bool with_single_frames) {
  TrackSets sets(correspondences.features);
  for (const FramePair& pair : correspondences.pairs) {
    for (const auto& [a, b] : pair.matches) {
      sets.Join({pair.a, static_cast<int>(a)}, {pair.b, static_cast<int>(b)});
    }
  }
  std::vector<Track> tracks;
  for (const Track& members : sets.Members()) {
    const bool alone = members.size() == 1;
    if (members.empty() || (alone && !with_single_frames)) continue;
    const FeatureRef& first = members.front();
    if (alone && !correspondences.features[first.frame][first.feature].right) continue;
    tracks.push_back(members);
  }
  return tracks;
}

std::vector<Track> CutTracks(std::vector<Track> tracks, const std::vector<int>& frames) {
  if (frames.empty()) return tracks;
  std::vector<Track> cut;
  for (const Track& track : tracks) {
    std::map<std::ptrdiff_t, Track> by_side;
    for (const auto& element : track) {
      by_side[std::ranges::upper_bound(frames, element.frame) - frames.begin()].push_back(element);
    }
    for (auto& [side, part] : by_side) cut.push_back(std::move(part));
  }
  return cut;
}

}  // namespace rigmap
