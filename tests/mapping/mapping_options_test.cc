#include "mapping/mapping_options.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(MappingOptions, DefaultsHold) {
  EXPECT_NO_THROW(RequireValid(MappingOptions{}));
  EXPECT_NO_THROW(RequireValid(KeyframeGraphOptions{}));
}

TEST(MappingOptions, NonsenseIsRefused) {
  EXPECT_THROW(RequireValid(MappingOptions{.seed_keyframes = 1}), UsageError);
  EXPECT_THROW(RequireValid(KeyframeGraphOptions{.tracks_per_keyframe = 0}), UsageError);
  EXPECT_THROW(RequireValid(MappingOptions{.min_model_keyframes = 1}), UsageError);
  EXPECT_THROW(RequireValid(MappingOptions{.max_models = 0}), UsageError);
}

TEST(MappingOptions, EveryFieldCanBeSet) {
  MappingOptions options;
  for (const OptionField& field : options.Fields()) {
    const bool is_choice = std::holds_alternative<OptionChoice>(field.value);
    SetOption("mapping", field.name, is_choice ? "unseeded" : "50", options.Fields());
  }
  EXPECT_EQ(options.method, MappingMethod::kUnseeded);
  EXPECT_EQ(options.seed_keyframes, 50);
  EXPECT_EQ(options.min_model_keyframes, 50);
  EXPECT_EQ(options.max_models, 50);
}

}  // namespace
}  // namespace rigmap
