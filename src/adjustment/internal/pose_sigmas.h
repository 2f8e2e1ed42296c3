// What adjusted poses are not known by, all told. Of this room only.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/camera_system.h"

namespace rigmap {

// The covariances of `system`, grown by its inflations and by noise that observations share; with
// what an error of the calibration, of this covariance, moves them by.
std::vector<Matrix6d> InflatedCovariances(const CameraSystemResult& system,
                                          const std::vector<std::optional<Rigid3>>& left_from_world,
                                          double shared_noise,
                                          const CalibrationMatrix& of_calibration);
// The same of the motions against references, the calibration held.
std::vector<std::optional<Matrix6d>> InflatedLinks(
    const CameraSystemResult& system, const std::vector<std::optional<Rigid3>>& left_from_world,
    double shared_noise);

}  // namespace rigmap
