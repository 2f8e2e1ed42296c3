#include "odometry/odometry_options.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(OdometryOptions, DefaultsAreValidAndReadBack) {
  OdometryOptions options;
  EXPECT_NO_THROW(RequireValid(options));
  SetOption("odometry", "min_inliers", "30", options.Fields());
  SetOption("odometry", "keypoint_noise_px", "0.5", options.Fields());
  EXPECT_EQ(options.min_inliers, 30);
  EXPECT_EQ(options.keypoint_noise_px, 0.5);
}

TEST(OdometryOptions, EveryFieldIsChecked) {
  OdometryOptions defaults;
  for (const OptionField& field : defaults.Fields()) {
    OdometryOptions options;
    EXPECT_THROW(SetOption("odometry", field.name, "-1", options.Fields()), UsageError)
        << field.name;
  }
}

}  // namespace
}  // namespace rigmap
