// The part of a rover part's correspondences that is given to COLMAP.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/correspondences.h"

namespace rigmap {

// One keyframe as two of COLMAP's images.
struct GraphKeyframe {
  int frame = 0;                      // index of the dataset's frame
  std::string left_name, right_name;  // "left/<stamp_ns>.<ext>"
  // Features (of Correspondences::features[frame]) that became left keypoints, in their order, and
  // for each the index of its right keypoint, if it has a stereo match.
  std::vector<int> features;
  std::vector<std::optional<std::uint32_t>> right_keypoints;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frame, left_name, right_name, features, right_keypoints);
  }
};

// Tracks name keyframes (index into `keyframes`) and left keypoints.
struct KeyframeGraph {
  std::vector<GraphKeyframe> keyframes;
  std::vector<Track> tracks;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(keyframes, tracks);
  }
};

}  // namespace rigmap
