// How high a map shows a rock.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "evaluation/internal/rock_truth.h"

namespace rigmap {

// Height of the map minus height of the truth over the rock's top, m: the visible surface within
// 2.5 cm, in plan, of its highest point. The median over square centimetres, each the mean of the
// vertical offsets of its points from the surface's tangent planes, if the map covers half of the
// top. If it does not, or if its third highest cubic centimetre is lower than the truth's by 15 mm
// more than that, the top is missing, and this lower figure holds. Nothing where the rock's top
// cannot be seen, and without map points within 6 cm. `map_points`: with their horizontal shift
// undone.
std::optional<double> TopOverTruth(std::span<const Eigen::Vector3d> map_points,
                                   const RockTruth& truth);

}  // namespace rigmap
