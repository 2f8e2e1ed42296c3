// Iterative closest points between two clouds, by PCL.
#pragma once

#include <optional>

#include "geometry/rigid3.h"
#include "registration/internal/pcl_cloud.h"
#include "registration/registration_options.h"
#include "scene/trajectory.h"

namespace rigmap {

struct CloudAlignment {
  Rigid3 target_from_source;
  bool converged = false;
  // Whether the surfaces hold the cloud in all directions. Normals of a smooth plane are noisy, and
  // noise looks as if it held; information is therefore taken from products of normals of either
  // cloud, whose noise is not the same.
  bool held = false;
  // Share of the source's points that have a counterpart within kCounterpartGrids boxes.
  double overlap = 0.0;
  double rms_m = 0.0;  // of their distances from the target's planes
  // Of target_from_source, as a left perturbation (translation m, rotation rad): what the planes
  // around the counterparts tell, whichever distances were made small. Residuals near each other go
  // together (cluster-robust, Liang and Zeger 1986). Zero where nothing holds.
  Matrix6d covariance = Matrix6d::Zero();
  // Of the way between both, metres, if every point were farther along its ray by its depth times
  // its depth over a metre, as it is by an offset of disparities; both clouds seen from their own
  // origins. Zero where nothing holds.
  double lengthening_m = 0.0;
};

inline constexpr double kCounterpartGrids = 2.0;

// `target` must have normals.
CloudAlignment Align(const PclCloud::Ptr& source, const PclCloud::Ptr& target,
                     const Rigid3& guessed_target_from_source, double grid_m,
                     const RegistrationOptions& options);

}  // namespace rigmap
