#include "mapping/mapping_options.h"

#include "core/error.h"

namespace rigmap {

void KeyframeGraphOptions::Validate() const {
  RequireOption(tracks_per_keyframe >= 50, "mapping.tracks_per_keyframe", "at least 50",
                tracks_per_keyframe);
}

OptionFields MappingOptions::Fields() {
  return {{"method", &method},
          {"seed_keyframes", &seed_keyframes},
          {"min_model_keyframes", &min_model_keyframes},
          {"max_models", &max_models}};
}

void MappingOptions::Validate() const {
  if (method != "seeded" && method != "triangulate" && method != "unseeded") {
    throw UsageError("option mapping.method: expected seeded, triangulate or unseeded, found '" +
                     method + "'");
  }
  RequireOption(seed_keyframes >= 2 && seed_keyframes <= 50, "mapping.seed_keyframes", "2 to 50",
                seed_keyframes);
  RequireOption(min_model_keyframes >= 2, "mapping.min_model_keyframes", "at least 2",
                min_model_keyframes);
  RequireOption(max_models >= 1, "mapping.max_models", "at least 1", max_models);
}

}  // namespace rigmap
