// The gates of a part: is the result to be trusted?
#pragma once

#include <optional>
#include <vector>

#include "gates/depth_consistency.h"
#include "gates/gate_options.h"
#include "scene/adjustment.h"
#include "scene/aligned_keyframes.h"
#include "scene/features.h"
#include "scene/gate.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// What the gates look at; what is not there does not apply.
struct GateInputs {
  const StereoRig& rig;
  const Odometry& odometry;
  const Adjustment& adjustment;
  const Trajectory& trajectory;
  const AlignedKeyframes* aligned = nullptr;
  bool rests_on_mapping = true;    // false: begun from the odometry, whatever was mapped
  std::vector<float> epipolar_px;  // median absolute error of each frame
  std::optional<DepthConsistency> depth_consistency;
  bool positions_known = true;  // whether the trajectory's covariances say anything
  // Relative, of all lengths, by what the calibration leaves unknown, where covariances do not hold
  // it.
  double calibration_scale_sigma = 0.0;
  double asked_offset_px = 0.0;  // of all disparities, by images that corrected none
};

// The gates on what COLMAP made: baseline_spread, baseline_rejected, registered.
struct MappedShape {
  std::optional<double> baseline_spread;  // of the model with the largest; nothing without any
  double baseline_rejected = 0.0;         // share of all pairs
  double registered = 0.0;                // share of keyframes
};
std::optional<MappedShape> ShapeOf(const AlignedKeyframes* aligned);  // nothing where there is none
Gates JudgeMapping(const std::optional<MappedShape>& shape, const MappingGateOptions& options);
bool AllPassed(const Gates& gates);

// A gate that passes while its value is at most the limit.
Gate AtMost(std::string name, std::optional<double> value, double limit, std::string why);
// Adds two gates on one thing, of which passing either will do.
void AddEither(Gate a, Gate b, Gates& gates);

// The gates on what the adjustment made of it: motion_agreement, reprojection_px, outlier_share.
Gates JudgeAdjustment(const GateInputs& inputs, const AdjustmentGateOptions& options);

// The gates on the calibration: epipolar_px, rig_refinement_px,
// infinity_offset_px, rig_consistency, intrinsics_consistency.
Gates JudgeCalibration(const GateInputs& inputs, const CalibrationGateOptions& options);

// The gates on the trajectory that came of it: predicted, breaks, scale_95_pct, position_95_pct.
Gates JudgePoses(const GateInputs& inputs, const PoseGateOptions& options);

// depth_consistency_pct: the systematic difference of stereo and temporal depth, over rings or over
// cells of the image, whichever is the surer to be large. It fails where it exceeds the accuracy
// asked for by two of its sigmas: such a depth field cannot give metres as good.
Gate JudgeDepthConsistency(const std::optional<DepthConsistency>& consistency,
                           const PoseGateOptions& options);

// All gates but depth_bias_px.
Gates JudgePart(const GateInputs& inputs, const GateOptions& options);
Gate JudgeDepthBias(std::optional<double> bias_px, const DepthGateOptions& options);

// "gate NAME is VALUE, limit LIMIT"
std::string FigureText(const Gate& gate);
// "gate NAME is VALUE, limit LIMIT: WHY" of all that failed, joined by "; ". Empty if none did.
std::string FailureReason(const Gates& gates);

}  // namespace rigmap
