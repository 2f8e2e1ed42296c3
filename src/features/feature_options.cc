#include "features/feature_options.h"

namespace rigmap {

OptionFields FeatureOptions::Fields() {
  return {{"max_keypoints", &max_keypoints},
          {"half_resolution_above_mpx", &half_resolution_above_mpx},
          {"contrast_threshold", &contrast_threshold},
          {"faint_contrast_threshold", &faint_contrast_threshold},
          {"edge_threshold", &edge_threshold},
          {"min_depth_baselines", &min_depth_baselines},
          {"epipolar_band_px", &epipolar_band_px},
          {"min_correlation", &min_correlation},
          {"min_uniqueness", &min_uniqueness},
          {"max_epipolar_sigmas", &max_epipolar_sigmas}};
}

void FeatureOptions::Validate() const {
  RequireOption(max_keypoints >= 50 && max_keypoints <= 50000, "features.max_keypoints",
                "50 to 50000", max_keypoints);
  RequireOption(half_resolution_above_mpx >= 0, "features.half_resolution_above_mpx", "0 or more",
                half_resolution_above_mpx);
  RequireOption(contrast_threshold >= 0.0 && contrast_threshold < 0.5,
                "features.contrast_threshold", "0 to 0.5", contrast_threshold);
  RequireOption(faint_contrast_threshold >= 0.0 && faint_contrast_threshold < 0.5,
                "features.faint_contrast_threshold", "0 to 0.5", faint_contrast_threshold);
  RequireOption(edge_threshold > 1.0, "features.edge_threshold", "more than 1", edge_threshold);
  RequireOption(min_depth_baselines >= 1.0, "features.min_depth_baselines", "at least 1",
                min_depth_baselines);
  RequireOption(epipolar_band_px >= 0.0 && epipolar_band_px <= 20.0, "features.epipolar_band_px",
                "0 to 20", epipolar_band_px);
  RequireOption(min_correlation > 0.0 && min_correlation < 1.0, "features.min_correlation",
                "between 0 and 1", min_correlation);
  RequireOption(min_uniqueness >= 0.0 && min_uniqueness < 1.0, "features.min_uniqueness", "0 to 1",
                min_uniqueness);
  RequireOption(max_epipolar_sigmas > 0.0, "features.max_epipolar_sigmas", "more than 0",
                max_epipolar_sigmas);
}

}  // namespace rigmap
