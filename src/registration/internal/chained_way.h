// What is known of the way between two frames of a chain. Of this room only.
#pragma once

#include <optional>

#include "scene/odometry.h"

namespace rigmap {

// Covariance of later_from_earlier as a left perturbation (translation m, rotation rad): that of
// the steps over which both frames hang on the nearest one that they have in common. Nothing where
// there is none.
std::optional<Matrix6d> CovarianceBetween(const Odometry& chain, int earlier, int later);

}  // namespace rigmap
