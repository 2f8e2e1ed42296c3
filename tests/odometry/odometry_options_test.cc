#include "odometry/odometry_options.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(OdometryOptions, DefaultsAreValidAndReadBack) {
  OdometryOptions options;
  EXPECT_NO_THROW(options.Validate());
  SetOption("odometry", "min_inliers", "30", options.Fields());
  SetOption("odometry", "keypoint_noise_px", "0.5", options.Fields());
  EXPECT_EQ(options.min_inliers, 30);
  EXPECT_EQ(options.keypoint_noise_px, 0.5);
}

TEST(OdometryOptions, EveryFieldIsChecked) {
  OdometryOptions defaults;
  for (const OptionField& field : defaults.Fields()) {
    OdometryOptions options;
    SetOption("odometry", field.name, "-1", options.Fields());
    EXPECT_THROW(options.Validate(), UsageError) << field.name;
  }
}

}  // namespace
}  // namespace rigmap
