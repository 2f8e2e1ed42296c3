#include "gates/gate_options.h"

namespace rigmap {

OptionFields MappingGateOptions::Fields() {
  return {{"baseline_spread", &baseline_spread},
          {"baseline_rejected", &baseline_rejected},
          {"registered", &registered}};
}

OptionFields PoseGateOptions::Fields() {
  return {{"predicted", &predicted},
          {"position_sigma_pct", &position_sigma_pct},
          {"scale_sigma_pct", &scale_sigma_pct}};
}

OptionFields AdjustmentGateOptions::Fields() {
  return {{"motion_agreement_sigmas", &motion_agreement_sigmas},
          {"motion_agreement_pct", &motion_agreement_pct},
          {"reprojection_px", &reprojection_px},
          {"outlier_share", &outlier_share}};
}

OptionFields CalibrationGateOptions::Fields() {
  return {{"epipolar_px", &epipolar_px},
          {"rig_refinement_sigmas", &rig_refinement_sigmas},
          {"max_depth_error_share", &max_depth_error_share},
          {"intrinsics_consistency_pct", &intrinsics_consistency_pct},
          {"consistency_sigmas", &consistency_sigmas}};
}

OptionFields DepthGateOptions::Fields() { return {{"depth_bias_px", &depth_bias_px}}; }

OptionFields GateOptions::Fields() {
  return JoinFields({mapping.Fields(), poses.Fields(), adjustment.Fields(), calibration.Fields(),
                     dense.Fields()});
}

void GateOptions::Validate() const {
  GateOptions copy = *this;
  for (const OptionField& field : copy.Fields()) {
    const double value = *std::get<double*>(field.value);
    RequireOption(value > 0.0, "gates." + field.name, "more than 0", value);
  }
}

}  // namespace rigmap
