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
  // for each the index of its right keypoint, if it has a partner.
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

// COLMAP's ids of keyframe k's images; cameras are 1 (left) and 2 (right).
constexpr std::uint32_t LeftImageId(int keyframe) {
  return 2U * static_cast<std::uint32_t>(keyframe) + 1U;
}
constexpr std::uint32_t RightImageId(int keyframe) { return LeftImageId(keyframe) + 1U; }
constexpr std::uint32_t kLeftCameraId = 1, kRightCameraId = 2;

}  // namespace rigmap
