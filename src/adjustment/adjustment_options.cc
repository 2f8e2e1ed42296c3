#include "adjustment/adjustment_options.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/error.h"

namespace rigmap {

OptionFields AdjustmentOptions::Fields() {
  return {{"refine_rig", &refine_rig},
          {"refine_sigmas", &refine_sigmas},
          {"rig_prior_deg", &rig_prior_deg},
          {"focal_prior_pct", &focal_prior_pct},
          {"principal_point_prior_px", &principal_point_prior_px},
          {"distortion_prior", &distortion_prior},
          {"huber_sigmas", &huber_sigmas},
          {"outlier_sigmas", &outlier_sigmas},
          {"min_noise_px", &min_noise_px},
          {"shared_noise", &shared_noise},
          {"max_depth_baselines", &max_depth_baselines},
          {"rounds", &rounds},
          {"max_iterations", &max_iterations},
          {"function_tolerance", &function_tolerance}};
}

void AdjustmentOptions::Validate() const {
  constexpr std::array<std::string_view, 5> kRefined{"none", "rotation", "rotation+focal", "all",
                                                     "auto"};
  if (std::find(kRefined.begin(), kRefined.end(), refine_rig) == kRefined.end()) {
    throw UsageError(fmt::format("option adjustment.refine_rig: expected one of {}, found '{}'",
                                 fmt::join(kRefined, ", "), refine_rig));
  }
  const auto positive = [](const char* name, double value) {
    RequireOption(value > 0.0, std::string("adjustment.") + name, "more than 0", value);
  };
  positive("refine_sigmas", refine_sigmas);
  positive("rig_prior_deg", rig_prior_deg);
  positive("focal_prior_pct", focal_prior_pct);
  positive("principal_point_prior_px", principal_point_prior_px);
  positive("distortion_prior", distortion_prior);
  positive("huber_sigmas", huber_sigmas);
  positive("outlier_sigmas", outlier_sigmas);
  positive("min_noise_px", min_noise_px);
  RequireOption(shared_noise >= 1.0, "adjustment.shared_noise", "1 or more", shared_noise);
  positive("max_depth_baselines", max_depth_baselines);
  positive("function_tolerance", function_tolerance);
  RequireOption(rounds >= 1 && rounds <= 20, "adjustment.rounds", "1 to 20", rounds);
  RequireOption(max_iterations >= 1, "adjustment.max_iterations", "1 or more", max_iterations);
}

}  // namespace rigmap
