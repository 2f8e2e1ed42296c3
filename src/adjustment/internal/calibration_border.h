// The normal equations of an adjustment bordered by the calibration, and by a field of the lens. Of
// this room only.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/calibration_blocks.h"
#include "adjustment/internal/field_system.h"
#include "adjustment/internal/reduced_system.h"

namespace rigmap {

// What a step of the calibration takes: less by far than all that SolveCameraSystem finds.
struct CalibrationSolution {
  CalibrationEquations equations;       // a field following
  std::vector<PoseResponse> responses;  // per frame
  // Of a field, and what the equations would be if it were held.
  std::optional<FieldSolution> field;
  CalibrationEquations equations_with_field_held;
};
// Poses and a field eliminated. Nothing where the system is singular.
std::optional<CalibrationSolution> SolveBorder(const ReducedSystem& system,
                                               const Linearisation& at);
std::optional<CalibrationSolution> SolveCalibration(const Linearisation& at);

// left_from_world as it follows, to first order, a step of the calibration.
Rigid3 Moved(const Rigid3& left_from_world, const PoseResponse& response,
             const CalibrationVector& calibration_step);

}  // namespace rigmap
