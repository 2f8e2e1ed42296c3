// The terms of the adjustment as Ceres wants them. Of this room only.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <memory>

#include "geometry/motion_block.h"
#include "scene/adjustment.h"

namespace rigmap {

// Perturbs as Reproject's Jacobians expect: the rotation from the left, the translation is added
// to. The first six "ambient" columns of a Jacobian hold the derivative by the perturbation itself:
// only costs made for it may use such a block.
std::unique_ptr<ceres::Manifold> MakeFrameManifold();

// Pixel residual of one observation. Blocks: frame (left_from_world), point. `rig` must outlive it.
std::unique_ptr<ceres::CostFunction> MakeReprojectionCost(const StereoRig& rig,
                                                          const PointObservation& observation);

}  // namespace rigmap
