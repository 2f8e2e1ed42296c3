#include "adjustment/adjustment_options.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(AdjustmentOptions, DefaultsHold) {
  AdjustmentOptions{}.Validate();
  for (const char* refine : {"none", "rotation", "rotation+focal", "all", "auto"}) {
    AdjustmentOptions{.refine_rig = refine}.Validate();
  }
}

TEST(AdjustmentOptions, NonsenseIsRefused) {
  EXPECT_THROW(AdjustmentOptions{.refine_rig = "everything"}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.refine_sigmas = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.rig_prior_deg = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.focal_prior_pct = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.principal_point_prior_px = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.distortion_prior = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.huber_sigmas = -1.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.outlier_sigmas = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.min_noise_px = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.shared_noise = 0.9}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.max_depth_baselines = 0.0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.rounds = 0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.max_iterations = 0}.Validate(), UsageError);
  EXPECT_THROW(AdjustmentOptions{.function_tolerance = 0.0}.Validate(), UsageError);
}

TEST(AdjustmentOptions, EveryFieldIsReadByItsName) {
  AdjustmentOptions options;
  for (const OptionField& field : options.Fields()) {
    const bool is_text = std::holds_alternative<std::string*>(field.value);
    SetOption("adjustment", field.name, is_text ? "rotation" : "7", options.Fields());
  }
  EXPECT_EQ(options.refine_rig, "rotation");
  EXPECT_EQ(options.refine_sigmas, 7.0);
  EXPECT_EQ(options.rig_prior_deg, 7.0);
  EXPECT_EQ(options.focal_prior_pct, 7.0);
  EXPECT_EQ(options.principal_point_prior_px, 7.0);
  EXPECT_EQ(options.distortion_prior, 7.0);
  EXPECT_EQ(options.huber_sigmas, 7.0);
  EXPECT_EQ(options.outlier_sigmas, 7.0);
  EXPECT_EQ(options.min_noise_px, 7.0);
  EXPECT_EQ(options.shared_noise, 7.0);
  EXPECT_EQ(options.max_depth_baselines, 7.0);
  EXPECT_EQ(options.rounds, 7);
  EXPECT_EQ(options.max_iterations, 7);
  EXPECT_EQ(options.function_tolerance, 7.0);
}

}  // namespace
}  // namespace rigmap
