#include "matching/matching_options.h"

namespace rigmap {

OptionFields MatchingOptions::Fields() {
  return {{"neighbours", &neighbours},
          {"min_overlap", &min_overlap},
          {"max_revisits", &max_revisits},
          {"revisit_candidates", &revisit_candidates},
          {"min_revisit_inliers", &min_revisit_inliers},
          {"sure_revisit_inliers", &sure_revisit_inliers},
          {"search_radius_px", &search_radius_px},
          {"max_search_radius_px", &max_search_radius_px},
          {"keypoint_noise_px", &keypoint_noise_px},
          {"disparity_noise_px", &disparity_noise_px},
          {"max_sigmas", &max_sigmas},
          {"min_inliers", &verification.min_inliers},
          {"min_correlation", &min_correlation},
          {"max_position_sigma_px", &max_position_sigma_px}};
}

void VerificationOptions::Validate() const {
  RequireOption(min_inliers >= 6, "matching.min_inliers", "at least 6", min_inliers);
}

void MatchingOptions::Validate() const {
  verification.Validate();
  const auto positive = [](const char* name, double value) {
    RequireOption(value > 0.0, std::string("matching.") + name, "more than 0", value);
  };
  RequireOption(neighbours >= 1 && neighbours <= 50, "matching.neighbours", "1 to 50", neighbours);
  RequireOption(min_overlap > 0.0 && min_overlap <= 1.0, "matching.min_overlap", "0 to 1",
                min_overlap);
  RequireOption(max_revisits >= 0, "matching.max_revisits", "0 or more", max_revisits);
  RequireOption(revisit_candidates >= 0, "matching.revisit_candidates", "0 or more",
                revisit_candidates);
  RequireOption(min_revisit_inliers >= 6, "matching.min_revisit_inliers", "at least 6",
                min_revisit_inliers);
  RequireOption(sure_revisit_inliers >= min_revisit_inliers, "matching.sure_revisit_inliers",
                "at least min_revisit_inliers", sure_revisit_inliers);
  RequireOption(min_correlation > 0.0 && min_correlation < 1.0, "matching.min_correlation",
                "between 0 and 1", min_correlation);
  positive("search_radius_px", search_radius_px);
  positive("max_search_radius_px", max_search_radius_px);
  positive("keypoint_noise_px", keypoint_noise_px);
  positive("disparity_noise_px", disparity_noise_px);
  positive("max_sigmas", max_sigmas);
  positive("max_position_sigma_px", max_position_sigma_px);
}

}  // namespace rigmap
