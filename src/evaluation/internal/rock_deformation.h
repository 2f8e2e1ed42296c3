// A rock's true surface laid onto the points of a map.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "evaluation/internal/rock_truth.h"
#include "evaluation/rock_metrics.h"

namespace rigmap {

// Both fits move the true surface, from point to tangent plane, onto the points of the map within 6
// cm whose nearest true point is one of the rock's core. Each patch of the core with three of them
// is one observation, their mean, weighted by its area and not by how many they are; Huber's
// weights, at 5 mm, hold for points and patches. What the patches leave open stays unmoved. `axes`
// as of ViewAxes. Nothing where there are fewer patches than unknowns and three.

// A translation. Nothing also where no whole patch faces any direction.
std::optional<RockShift> FitShift(std::span<const Eigen::Vector3d> map_points,
                                  const RockTruth& truth, const Eigen::Matrix3d& axes);

// A translation and stretches along the axes, about the middle of the core.
std::optional<RockStretch> FitStretch(std::span<const Eigen::Vector3d> map_points,
                                      const RockTruth& truth, const Eigen::Matrix3d& axes);

}  // namespace rigmap
