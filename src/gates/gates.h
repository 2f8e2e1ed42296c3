// The gates of a part: is the result to be trusted?
#pragma once

#include <optional>
#include <vector>

#include "core/options.h"
#include "scene/adjustment.h"
#include "scene/features.h"
#include "scene/gate.h"
#include "scene/odometry.h"
#include "scene/placed_keyframes.h"
#include "scene/rig.h"

namespace rigmap {

struct GateOptions {
  // Healthy seeded models spread by 0.1 to 0.94 %, failed ones by 3 % and more.
  double baseline_spread = 0.02;
  double baseline_rejected = 0.2;
  // Share of keyframes that must be posed by the mapper.
  double registered = 0.9;
  // Share of frames that nothing measured. A black image or two may be bridged; where more than a
  // fifth of the trajectory is guessed it is not a measurement any more.
  double predicted = 0.2;
  // Root mean square of the position sigmas of all other frames, per cent of the path (or of a
  // metre, if it is shorter): what the result says of itself. Tracked parts have 0.01 to 0.05.
  double position_sigma_pct = 0.1;
  // Sigma of the distance from the first to the farthest measured frame, per cent of it (or of a
  // metre, if it is shorter): 0.2 % is twice this.
  double scale_sigma_pct = 0.1;
  // Mapped against odometric steps: their difference in sigmas of the odometry (whose sigmas know
  // nothing of the motion of whole image regions, hence not 3), and in per cent of the step. A step
  // fails only if it is beyond both; the gate, if a tenth of the steps fails.
  double motion_agreement_sigmas = 10.0;
  double motion_agreement_pct = 5.0;
  // Median; a healthy part has 0.1 px where images are sharp, and 0.5 px where they are poor.
  double reprojection_px = 1.0;
  double outlier_share = 0.3;
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
  // Disparities of SGM against those of sparse points; at 3 m 0.1 px is 0.3 % of the depth.
  double depth_bias_px = 0.1;

  OptionFields Fields();
  void Validate() const;  // throws UsageError
};

// What the gates look at; what is not there does not apply.
struct GateInputs {
  const StereoRig& rig;
  const Odometry& odometry;
  const Adjustment& adjustment;
  const Trajectory& trajectory;
  const PlacedKeyframes* placed = nullptr;
  std::vector<float> epipolar_px;  // median absolute error of each frame
};

// The gates on what COLMAP made: baseline_spread, baseline_rejected, registered.
Gates JudgeMapping(const PlacedKeyframes* placed, const GateOptions& options);
bool AllPassed(const Gates& gates);

// A gate that passes while its value is at most the limit.
Gate AtMost(std::string name, std::optional<double> value, double limit, std::string why);
// Adds two gates on one thing, of which passing either will do.
void AddEither(Gate a, Gate b, Gates& gates);

// The gates on what the adjustment made of it: motion_agreement, reprojection_px, outlier_share.
Gates JudgeAdjustment(const GateInputs& inputs, const GateOptions& options);

// The gates on the calibration: epipolar_px, rig_refinement_sigmas, rig_consistency,
// intrinsics_consistency.
Gates JudgeCalibration(const GateInputs& inputs, const GateOptions& options);

// All gates but depth_bias_px.
Gates JudgePart(const GateInputs& inputs, const GateOptions& options);
Gate JudgeDepthBias(std::optional<double> bias_px, const GateOptions& options);

// "gate NAME: WHY" of all that failed, joined by "; ". Empty if none did.
std::string FailureReason(const Gates& gates);

}  // namespace rigmap
