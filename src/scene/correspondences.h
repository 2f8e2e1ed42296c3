// Which features of which frames show the same ground.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "scene/features.h"
#include "scene/trajectory.h"

namespace rigmap {

// Matches between two frames (indices into Correspondences::features), a < b, one to one.
struct FramePair {
  int a = 0, b = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> matches;  // feature of a, feature of b

  template <class Archive>
  void serialize(Archive& archive) {
    archive(a, b, matches);
  }
};

// Two frames, a < b, that show the same ground, out of view in between, and the motion that their
// matches agree with.
struct LoopClosure {
  int a = 0, b = 0;
  Rigid3 b_from_a;                         // metres
  Matrix6d covariance = Matrix6d::Zero();  // of a left perturbation (translation m, rotation rad)
  bool by_appearance = false;              // found by its appearance, without the odometry

  template <class Archive>
  void serialize(Archive& archive) {
    archive(a, b, b_from_a, covariance, by_appearance);
  }
};

// Verified correspondences of a part. features[f] are frame f's, in the order in which they were
// extracted, then those that were sampled there; their positions refined so that all views of a
// ground point mean the same spot of ground.
struct Correspondences {
  std::vector<std::vector<Feature>> features;
  std::vector<FramePair> pairs;
  std::vector<LoopClosure> loop_closures;  // of some of the pairs

  template <class Archive>
  void serialize(Archive& archive) {
    archive(features, pairs, loop_closures);
  }
};

// One feature of one frame.
struct FeatureRef {
  int frame = 0;
  int feature = 0;

  // clang-tidy takes the zero that <=> is compared with for a pointer.
  auto operator<=>(const FeatureRef&) const = default;  // NOLINT(modernize-use-nullptr)

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frame, feature);
  }
};

// The features that show one point, at most one per frame, in order of frames.
using Track = std::vector<FeatureRef>;

}  // namespace rigmap
