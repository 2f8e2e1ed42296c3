// The normal equations of an adjustment with the points eliminated: how sure the poses are, and
// where the calibration would move if it were free.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/calibration_border.h"
#include "scene/adjustment.h"

namespace rigmap {

// What is known of the scale of the positions: of the factor that a similarity alignment with the
// true ones would find.
struct ScaleKnowledge {
  double variance = 0.0;  // of the observations, correlations within tracks counted
  CalibrationVector by_calibration = CalibrationVector::Zero();  // its derivative
};

struct CameraSystemResult {
  // Per frame, its datum frame, whose pose was held (DatumFrames); itself for the frames held and
  // those without points.
  std::vector<int> datum_frames;
  // Of world_from_left relative to the frame's datum frame, in the axes of the adjustment's world:
  // translation (m), then rotation (rad). Zero for datum frames; 1e6 on the diagonal where the
  // system is singular. As if all observations were independent.
  std::vector<Matrix6d> covariances;
  // Per frame, of its motion against its reference, in the same axes; nothing for frames without
  // one in their group. Empty where the system is singular.
  std::vector<std::optional<Matrix6d>> link_covariances;
  // Covariance inflation per frame: the factor on its sigmas, along and about the left camera's
  // axes, because residuals of one track are correlated (ScoreClusters). At least 1. Noise that all
  // observations of a frame share leaves no trace in the residuals and is not in it.
  std::vector<Vector6d> inflations;
  // What the part says of the calibration that was held; nothing where the system is singular.
  std::optional<CalibrationEquations> calibration;
  // Per frame, d(world_from_left)/d(calibration), as the adjusted pose follows it: translation (m)
  // and rotation in world axes. Zero for datum frames; empty without calibration.
  std::vector<Eigen::Matrix<double, 6, kCalibrationSize>> by_calibration;
  // Nothing without calibration, with several datum frames or for a rig that stands.
  std::optional<ScaleKnowledge> scale;
};

// Linearises all observations at the adjusted state, eliminates the points and factorises the rest,
// a sparse block matrix over frames. Time and memory are linear in the length of a part without
// long loops. `references`: per frame, another one; none if empty.
CameraSystemResult SolveCameraSystem(const Linearisation& at,
                                     const std::vector<int>& references = {});

}  // namespace rigmap
