// Keyframes that mapping posed, in metres.
#pragma once

#include <optional>
#include <vector>

#include "geometry/rigid3.h"
#include "geometry/serialize.h"

namespace rigmap {

// What the distances between left and right cameras say of a model's unit.
struct BaselineScale {
  double metres_per_model_unit = 0.0;
  double relative_spread = 0.0;  // 1.4826 MAD / median of all distances, before any is rejected
  std::vector<int> pairs_used;   // keyframes
  std::vector<int> pairs_rejected;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(metres_per_model_unit, relative_spread, pairs_used, pairs_rejected);
  }
};

// A model laid into the world.
struct AlignedModel {
  int model = 0;  // index into the models given
  Sim3 world_from_model;
  BaselineScale scale;
  std::vector<int> keyframes;  // posed by this model

  template <class Archive>
  void serialize(Archive& archive) {
    archive(model, world_from_model, scale, keyframes);
  }
};

struct AlignedKeyframes {
  // Per keyframe, metres; empty where none was to be mapped.
  std::vector<std::optional<Rigid3>> world_from_left;
  std::vector<AlignedModel> models;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(world_from_left, models);
  }
};

}  // namespace rigmap
