#include "adjustment/adjustment_options.h"

#include "core/error.h"

namespace rigmap {

OptionFields AdjustmentOptions::Fields() {
  return {{"refine_rig", &refine_rig},
          {"rig_prior_deg", &rig_prior_deg},
          {"huber_sigmas", &huber_sigmas},
          {"outlier_sigmas", &outlier_sigmas},
          {"min_noise_px", &min_noise_px},
          {"max_depth_baselines", &max_depth_baselines},
          {"rounds", &rounds},
          {"max_iterations", &max_iterations},
          {"function_tolerance", &function_tolerance}};
}

void AdjustmentOptions::Validate() const {
  if (refine_rig != "none" && refine_rig != "rotation") {
    throw UsageError("option adjustment.refine_rig: expected none or rotation, found '" +
                     refine_rig + "'");
  }
  const auto positive = [](const char* name, double value) {
    RequireOption(value > 0.0, std::string("adjustment.") + name, "more than 0", value);
  };
  positive("rig_prior_deg", rig_prior_deg);
  positive("huber_sigmas", huber_sigmas);
  positive("outlier_sigmas", outlier_sigmas);
  positive("min_noise_px", min_noise_px);
  positive("max_depth_baselines", max_depth_baselines);
  positive("function_tolerance", function_tolerance);
  RequireOption(rounds >= 1 && rounds <= 20, "adjustment.rounds", "1 to 20", rounds);
  RequireOption(max_iterations >= 1, "adjustment.max_iterations", "1 or more", max_iterations);
}

}  // namespace rigmap
