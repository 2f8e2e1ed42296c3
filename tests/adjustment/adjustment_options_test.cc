#include "adjustment/adjustment_options.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace rigmap {
namespace {

TEST(AdjustmentOptions, DefaultsHold) { EXPECT_NO_THROW(RequireValid(AdjustmentOptions{})); }

TEST(AdjustmentOptions, NonsenseIsRefused) {
  AdjustmentOptions defaults;
  for (const OptionField& field : defaults.Fields()) {
    if (field.name == std::string("lens_field_px")) continue;  // of which 0 is none
    AdjustmentOptions options;
    EXPECT_THROW(SetOption("adjustment", field.name, "0", options.Fields()), UsageError)
        << field.name;
  }
  EXPECT_THROW(RequireValid(AdjustmentOptions{.shared_noise = 0.9}), UsageError);
}

TEST(AdjustmentOptions, EveryFieldIsReadByItsName) {
  AdjustmentOptions options;
  for (const OptionField& field : options.Fields()) {
    const bool is_choice = std::holds_alternative<OptionChoice>(field.value);
    SetOption("adjustment", field.name, is_choice ? "rotation" : "7", options.Fields());
  }
  EXPECT_EQ(options.refine_rig, RigRefinement::kRotation);
  EXPECT_EQ(options.refine_sigmas, 7.0);
  EXPECT_EQ(options.rig_prior_deg, 7.0);
  EXPECT_EQ(options.focal_prior_pct, 7.0);
  EXPECT_EQ(options.principal_point_prior_px, 7.0);
  EXPECT_EQ(options.distortion_prior_px, 7.0);
  EXPECT_EQ(options.huber_sigmas, 7.0);
  EXPECT_EQ(options.outlier_sigmas, 7.0);
  EXPECT_EQ(options.min_noise_px, 7.0);
  EXPECT_EQ(options.shared_noise, 7.0);
  EXPECT_EQ(options.max_depth_baselines, 7.0);
  EXPECT_EQ(options.rounds, 7);
}

}  // namespace
}  // namespace rigmap
