// Options of the stage `mapping`.
#pragma once

#include <string>

#include "core/options.h"

namespace rigmap {

// What COLMAP is given to map with.
struct KeyframeGraphOptions {
  // Tracks given to COLMAP per keyframe, longest first: its cost is linear in them, and the
  // adjustment afterwards uses all.
  int tracks_per_keyframe = 300;

  OptionFields Fields() { return {{"tracks_per_keyframe", &tracks_per_keyframe}}; }
  void Validate() const;  // throws UsageError
};

struct MappingOptions {
  // "seeded": incremental mapping that starts from metric frames of the odometry (default, forgives
  // bad odometry); "triangulate": points on the odometric poses; "unseeded": stock incremental
  // mapping, for comparison only, since it maps flat sand wrongly without noticing.
  std::string method = "seeded";
  // Keyframes in a seed. 2, 4 and 8 do equally well; four survive one bad step.
  int seed_keyframes = 4;
  // Further models are seeded where COLMAP left so many keyframes in a row.
  int min_model_keyframes = 4;
  int max_models = 20;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
