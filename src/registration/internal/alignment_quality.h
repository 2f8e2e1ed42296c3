// How good a registration is.
#pragma once

#include "registration/internal/cloud_alignment.h"

namespace rigmap {

// Weight of a pair's distance off the plane of its target, both clouds seen from about `camera`:
// both points are known by their sigmas along rays, of which a plane seen edge on shows little.
float WeightOf(const PclPoint& source, const PclPoint& target, const Eigen::Vector3f& camera,
               double grid_m);

// Fills in what the planes of the target say of the source where it was registered: all of
// `alignment` but the motion and whether it converged. Pairs that the options reject do not count.
void Judge(const PclCloud& source, const PclCloud::Ptr& target, double grid_m,
           const RegistrationOptions& options, CloudAlignment& alignment);

}  // namespace rigmap
