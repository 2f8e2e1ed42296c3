// Options of the stages `database` and `mapping`.
#pragma once

#include "core/options.h"
#include "scene/mapping_method.h"

namespace rigmap {

// What each option does and why it has its default: the declarations in mapping_options.cc.

// What COLMAP is given to map with.
struct KeyframeGraphOptions {
  static constexpr const char* kSection = "mapping";

  int tracks_per_keyframe = 200;

  OptionFields Fields();
};

struct MappingOptions {
  static constexpr const char* kSection = "mapping";

  MappingMethod method = MappingMethod::kSeeded;
  int seed_keyframes = 4;
  int min_model_keyframes = 4;
  int max_models = 20;
  int random_seed = 0;

  OptionFields Fields();
};

}  // namespace rigmap
