#include "dense/dense_options.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace rigmap {

OptionFields DenseOptions::Fields() {
  return {{"method", &method},
          {"block_px", &block_px},
          {"small_step_cost", &small_step_cost},
          {"large_step_cost", &large_step_cost},
          {"uniqueness_pct", &uniqueness_pct},
          {"left_right_px", &left_right_px},
          {"speckle_size_px", &speckle_size_px},
          {"speckle_step_px", &speckle_step_px},
          {"refinement_px", &refinement_px},
          {"smoothing_px", &smoothing_px},
          {"refined_sigma_factor", &refined_sigma_factor},
          {"least_sigma_px", &least_sigma_px},
          {"min_depth_m", &min_depth_m},
          {"disparity_sigma_px", &disparity_sigma_px},
          {"max_range_m", &max_range_m},
          {"max_depth_sigma_m", &max_depth_sigma_m}};
}

void DenseOptions::Validate() const {
  if (method != "sgm" && method != "bm") {
    throw UsageError(fmt::format("option dense.method: expected sgm or bm, found {}", method));
  }
  RequireOption(block_px >= 1 && block_px % 2 == 1, "dense.block_px", "an odd number", block_px);
  RequireOption(method != "bm" || block_px >= 5, "dense.block_px", "at least 5 for method bm",
                block_px);
  RequireOption(small_step_cost > 0.0, "dense.small_step_cost", "above 0", small_step_cost);
  RequireOption(large_step_cost > small_step_cost, "dense.large_step_cost",
                "above dense.small_step_cost", large_step_cost);
  RequireOption(uniqueness_pct >= 0 && uniqueness_pct <= 100, "dense.uniqueness_pct", "0 to 100",
                uniqueness_pct);
  RequireOption(left_right_px >= 0, "dense.left_right_px", "at least 0", left_right_px);
  RequireOption(speckle_size_px >= 0, "dense.speckle_size_px", "at least 0", speckle_size_px);
  RequireOption(speckle_step_px >= 1, "dense.speckle_step_px", "at least 1", speckle_step_px);
  RequireOption(refinement_px >= 3 && refinement_px % 2 == 1, "dense.refinement_px",
                "an odd number of at least 3", refinement_px);
  RequireOption(smoothing_px >= 1 && smoothing_px % 2 == 1, "dense.smoothing_px", "an odd number",
                smoothing_px);
  RequireOption(refined_sigma_factor > 0.0, "dense.refined_sigma_factor", "above 0",
                refined_sigma_factor);
  RequireOption(least_sigma_px > 0.0, "dense.least_sigma_px", "above 0", least_sigma_px);
  RequireOption(min_depth_m > 0.0, "dense.min_depth_m", "above 0", min_depth_m);
  RequireOption(disparity_sigma_px > 0.0, "dense.disparity_sigma_px", "above 0",
                disparity_sigma_px);
  RequireOption(max_range_m == 0.0 || max_range_m > min_depth_m, "dense.max_range_m",
                "0 or above dense.min_depth_m", max_range_m);
  RequireOption(max_depth_sigma_m > 0.0, "dense.max_depth_sigma_m", "above 0", max_depth_sigma_m);
}

double DenseOptions::MaxDepth(double focal_px, double baseline_m) const {
  if (max_range_m > 0.0) return max_range_m;
  return std::sqrt(max_depth_sigma_m * focal_px * baseline_m / disparity_sigma_px);
}

}  // namespace rigmap
