#include "mapping/build_graph.h"

#include <algorithm>
#include <map>

#include "correspondence/tracks.h"

namespace rigmap {
namespace {

// Each view of a ground point is matched with so many views after it. COLMAP's cost is linear in
// matches, and a point seen fifty times needs no match of its first view with its last.
constexpr std::size_t kTrackNeighbours = 4;

// Tracks with their frames replaced by keyframe indices; frames that are none are passed over.
std::vector<Track> KeyframeTracks(const Correspondences& correspondences,
                                  const std::vector<int>& keyframe_of_frame) {
  std::vector<Track> tracks;
  for (const Track& track : BuildTracks(correspondences, false)) {
    Track kept;
    bool stereo = false;
    for (const auto& [frame, feature] : track) {
      if (keyframe_of_frame[frame] < 0) continue;
      kept.push_back({keyframe_of_frame[frame], feature});
      stereo = stereo || correspondences.features[frame][feature].right.has_value();
    }
    if (kept.size() >= 2 && stereo) tracks.push_back(std::move(kept));
  }
  return tracks;
}

std::vector<Track> ChooseTracks(std::vector<Track> tracks, std::size_t keyframes, int share) {
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const Track& a, const Track& b) { return a.size() > b.size(); });
  std::vector<int> have(keyframes, 0);
  std::vector<Track> chosen;
  for (Track& track : tracks) {
    const bool wanted = std::any_of(track.begin(), track.end(),
                                    [&](const FeatureRef& ref) { return have[ref.frame] < share; });
    if (!wanted) continue;
    for (const FeatureRef& ref : track) ++have[ref.frame];
    chosen.push_back(std::move(track));
  }
  return chosen;
}

}  // namespace

KeyframeGraph BuildKeyframeGraph(const Correspondences& correspondences, const Odometry& odometry,
                                 const Dataset& dataset, const KeyframeGraphOptions& options) {
  KeyframeGraph graph;
  std::vector<int> keyframe_of_frame(odometry.size(), -1);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (!odometry[i].keyframe) continue;
    keyframe_of_frame[i] = static_cast<int>(graph.keyframes.size());
    const StereoFrame& frame = dataset.frames[i];
    graph.keyframes.push_back(
        {static_cast<int>(i), ImageName(frame, Eye::kLeft), ImageName(frame, Eye::kRight)});
  }
  graph.tracks = ChooseTracks(KeyframeTracks(correspondences, keyframe_of_frame),
                              graph.keyframes.size(), options.tracks_per_keyframe);
  std::vector<std::uint32_t> right_count(graph.keyframes.size(), 0);
  for (Track& track : graph.tracks) {
    for (FeatureRef& ref : track) {
      GraphKeyframe& keyframe = graph.keyframes[ref.frame];
      const bool has_stereo_match =
          correspondences.features[keyframe.frame][ref.feature].right.has_value();
      keyframe.features.push_back(ref.feature);
      keyframe.right_keypoints.push_back(has_stereo_match ? std::optional(right_count[ref.frame]++)
                                                          : std::nullopt);
      ref.feature = static_cast<int>(keyframe.features.size()) - 1;
    }
  }
  return graph;
}

DatabaseContent MakeDatabaseContent(const KeyframeGraph& graph,
                                    const Correspondences& correspondences, const StereoRig& rig) {
  DatabaseContent content;
  content.cameras = {{Eye::kLeft, rig.left.camera}, {Eye::kRight, rig.right.camera}};
  for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
    const GraphKeyframe& keyframe = graph.keyframes[k];
    const int index = static_cast<int>(k);
    DatabaseImage left{{index, Eye::kLeft}, keyframe.left_name, {}};
    DatabaseImage right{{index, Eye::kRight}, keyframe.right_name, {}};
    DatabasePair stereo{left.ref, right.ref, {}};
    for (std::size_t i = 0; i < keyframe.features.size(); ++i) {
      const Feature& feature = correspondences.features[keyframe.frame][keyframe.features[i]];
      left.keypoints.push_back(feature.left.cast<float>());
      if (!keyframe.right_keypoints[i]) continue;
      right.keypoints.push_back(feature.right->cast<float>());
      stereo.matches.emplace_back(static_cast<std::uint32_t>(i), *keyframe.right_keypoints[i]);
    }
    content.images.push_back(std::move(left));
    content.images.push_back(std::move(right));
    content.pairs.push_back(std::move(stereo));
  }
  std::map<std::pair<int, int>, DatabasePair> between;
  for (const Track& track : graph.tracks) {
    for (std::size_t i = 0; i < track.size(); ++i) {
      for (std::size_t j = i + 1; j < std::min(track.size(), i + 1 + kTrackNeighbours); ++j) {
        DatabasePair& pair = between[{track[i].frame, track[j].frame}];
        pair.image_a = {track[i].frame, Eye::kLeft};
        pair.image_b = {track[j].frame, Eye::kLeft};
        pair.matches.emplace_back(track[i].feature, track[j].feature);
      }
    }
  }
  for (auto& [frames, pair] : between) content.pairs.push_back(std::move(pair));
  return content;
}

}  // namespace rigmap
