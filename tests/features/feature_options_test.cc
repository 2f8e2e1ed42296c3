#include "features/feature_options.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(FeatureOptions, DefaultsAreValidAndReadBack) {
  FeatureOptions options;
  EXPECT_NO_THROW(RequireValid(options));
  SetOption("features", "max_keypoints", "700", options.Fields());
  SetOption("features", "epipolar_band_px", "2.5", options.Fields());
  EXPECT_EQ(options.max_keypoints, 700);
  EXPECT_EQ(options.epipolar_band_px, 2.5);
}

TEST(FeatureOptions, EveryFieldIsChecked) {
  FeatureOptions defaults;
  for (const OptionField& field : defaults.Fields()) {
    FeatureOptions options;
    EXPECT_THROW(SetOption("features", field.name, "-1", options.Fields()), UsageError)
        << field.name;
  }
}

}  // namespace
}  // namespace rigmap
