// The normal equations of an adjustment with the points eliminated: how sure the poses are, and
// where the calibration would move if it were free.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjusted_points.h"
#include "scene/trajectory.h"

namespace rigmap {

// What the adjusted part says of the calibration that was held fixed: the step that the right eye's
// rotation (radians, right camera axes) and the logarithm of a common focal factor would take
// together, with their sigmas.
struct CalibrationStep {
  Eigen::Vector3d rig_rotation = Eigen::Vector3d::Zero();
  Eigen::Vector3d rig_rotation_sigma = Eigen::Vector3d::Zero();
  double log_focal = 0.0;
  double log_focal_sigma = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rig_rotation, rig_rotation_sigma, log_focal, log_focal_sigma);
  }
};

struct CameraSystemResult {
  // Per frame, the frame whose pose was fixed for it: the first of those that it hangs together
  // with (AnchorFrames); itself for the fixed frames and those without points.
  std::vector<int> anchors;
  // Of world_from_left relative to the frame's anchor, in the axes of the adjustment's world:
  // translation (m), then rotation (rad). Zero for anchors; 1e6 on the diagonal where the system is
  // singular. As if all observations were independent.
  std::vector<Matrix6d> covariances;
  // Per frame, by how much sigmas grow, along and about the left camera's axes, because residuals
  // of one track go together (ScoreClusters): at least 1. Noise that all observations of a frame
  // share leaves no trace in the residuals and is not in it.
  std::vector<Vector6d> inflations;
  std::optional<CalibrationStep> calibration;  // nothing where the system cannot tell
};

// Linearises all observations at the adjusted state (weights as Huber's at `huber_px`, noise
// `noise_px`), eliminates the points and factorises the rest, a sparse block matrix over frames.
// Time and memory are linear in the length of a part without long loops.
CameraSystemResult SolveCameraSystem(const std::vector<AdjustedPoint>& points,
                                     const std::vector<std::optional<Rigid3>>& left_from_world,
                                     const StereoRig& rig, double noise_px, double huber_px);

}  // namespace rigmap
