#include "mapping/mapping_options.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(MappingOptions, DefaultsHoldAndEveryMethodIsKnown) {
  for (const char* method : {"seeded", "triangulate", "unseeded"}) {
    MappingOptions{.method = method}.Validate();
  }
}

TEST(MappingOptions, NonsenseIsRefused) {
  EXPECT_THROW(MappingOptions{.seed_keyframes = 1}.Validate(), UsageError);
  EXPECT_THROW(KeyframeGraphOptions{.tracks_per_keyframe = 0}.Validate(), UsageError);
  EXPECT_THROW(MappingOptions{.min_model_keyframes = 1}.Validate(), UsageError);
  EXPECT_THROW(MappingOptions{.max_models = 0}.Validate(), UsageError);
  try {
    MappingOptions{.method = "guess"}.Validate();
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("mapping.method"));
    EXPECT_THAT(error.what(), testing::HasSubstr("'guess'"));
  }
}

TEST(MappingOptions, EveryFieldCanBeSet) {
  MappingOptions options;
  for (const OptionField& field : options.Fields()) {
    const bool is_text = std::holds_alternative<std::string*>(field.value);
    SetOption("mapping", field.name, is_text ? "unseeded" : "77", options.Fields());
  }
  EXPECT_EQ(options.method, "unseeded");
  EXPECT_EQ(options.seed_keyframes, 77);
  EXPECT_EQ(options.min_model_keyframes, 77);
  EXPECT_EQ(options.max_models, 77);
}

}  // namespace
}  // namespace rigmap
