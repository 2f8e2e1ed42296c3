// Limits of the gates, by what they are judged on.
#pragma once

#include "core/options.h"

namespace rigmap {

// What each limit means and why it has its default: the declarations in gate_options.cc.

// On the models that COLMAP made.
struct MappingGateOptions {
  static constexpr const char* kSection = "gates";

  double baseline_spread = 0.02;
  double baseline_rejected = 0.2;
  double registered = 0.9;

  OptionFields Fields();
};

// On the trajectory.
struct PoseGateOptions {
  static constexpr const char* kSection = "gates";

  double predicted = 0.2;
  double breaks = 0.0;
  double accuracy_pct = 1.0;

  OptionFields Fields();
};

// On the adjustment's own residuals, and on how it moved the odometry.
struct AdjustmentGateOptions {
  static constexpr const char* kSection = "gates";

  double motion_agreement_sigmas = 10.0;
  double motion_agreement_pct = 5.0;
  double reprojection_px = 1.0;
  double outlier_share = 0.3;

  OptionFields Fields();
};

// On the rig's calibration.
struct CalibrationGateOptions {
  static constexpr const char* kSection = "gates";

  double epipolar_px = 1.0;
  double rig_refinement_share = 0.01;
  double max_depth_error_share = 0.002;
  double intrinsics_consistency_pct = 0.2;
  double consistency_sigmas = 2.0;

  OptionFields Fields();
};

// On dense matching.
struct DepthGateOptions {
  static constexpr const char* kSection = "gates";

  double depth_bias_px = 0.1;

  OptionFields Fields();
};

// On clouds chained by ICP.
struct RegistrationGateOptions {
  static constexpr const char* kSection = "gates";

  double unheld = 0.2;
  double closure_sigmas = 5.0;
  double closure_pct = 5.0;

  OptionFields Fields();
};

struct GateOptions {
  static constexpr const char* kSection = "gates";

  MappingGateOptions mapping;
  PoseGateOptions poses;
  AdjustmentGateOptions adjustment;
  CalibrationGateOptions calibration;
  DepthGateOptions dense;
  RegistrationGateOptions registration;

  OptionFields Fields();
};

}  // namespace rigmap
