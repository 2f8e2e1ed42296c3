// Limits of the gates, by what they are judged on.
#pragma once

#include "core/options.h"

namespace rigmap {

// On the models that COLMAP made.
struct MappingGateOptions {
  // Healthy seeded models spread by 0.1 to 0.94 %, failed ones by 3 % and more.
  double baseline_spread = 0.02;
  double baseline_rejected = 0.2;
  // Share of keyframes that must be posed by the mapper.
  double registered = 0.9;

  OptionFields Fields();
};

// On the trajectory.
struct PoseGateOptions {
  // Share of frames that nothing measured. A black image or two may be bridged; where more than a
  // fifth of the trajectory is guessed it is not a measurement any more.
  double predicted = 0.2;
  // Root mean square of the position sigmas of all other frames, per cent of the path (or of a
  // metre, if it is shorter): what the result says of itself. Tracked parts have 0.01 to 0.05.
  double position_sigma_pct = 0.1;
  // Sigma of the distance from the first to the farthest measured frame, per cent of it (or of a
  // metre, if it is shorter): 0.2 % is twice this.
  double scale_sigma_pct = 0.1;

  OptionFields Fields();
};

// On the adjustment's own residuals, and on how it moved the odometry.
struct AdjustmentGateOptions {
  // Mapped against odometric steps: their difference in sigmas of the odometry (whose sigmas know
  // nothing of the motion of whole image regions, hence not 3), and in per cent of the step. A step
  // fails only if it is beyond both; the gate, if a tenth of the steps fails.
  double motion_agreement_sigmas = 10.0;
  double motion_agreement_pct = 5.0;
  // Median; a healthy part has 0.1 px where images are sharp, and 0.5 px where they are poor.
  double reprojection_px = 1.0;
  double outlier_share = 0.3;

  OptionFields Fields();
};

// On the rig's calibration.
struct CalibrationGateOptions {
  // Good real rigs have up to 0.6 px.
  double epipolar_px = 1.0;
  // A correction of the rig beyond so many sigmas of the adjustment's prior is another rig's.
  double rig_refinement_sigmas = 3.0;
  // A turn of the right eye by a shifts disparities by f a, which is a share a z / b of the depth
  // at z. The limit is the turn at which the median tracked point would be off by this share.
  double max_depth_error_share = 0.002;
  // A focal length off by a share makes depths wrong by the same share (per cent).
  double intrinsics_consistency_pct = 0.2;
  // Corrections of the calibration below so many of their sigmas may be chance.
  double consistency_sigmas = 5.0;

  OptionFields Fields();
};

// On dense matching.
struct DepthGateOptions {
  // Disparities of SGM against those of sparse points; at 3 m 0.1 px is 0.3 % of the depth.
  double depth_bias_px = 0.1;

  OptionFields Fields();
};

struct GateOptions {
  MappingGateOptions mapping;
  PoseGateOptions poses;
  AdjustmentGateOptions adjustment;
  CalibrationGateOptions calibration;
  DepthGateOptions dense;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

}  // namespace rigmap
