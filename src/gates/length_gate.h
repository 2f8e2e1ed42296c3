// Whether poses of techniques that nothing holds to the rig are as far apart as the odometry says.
#pragma once

#include <optional>
#include <vector>

#include "gates/gates.h"
#include "geometry/rigid3.h"
#include "scene/odometry.h"

namespace rigmap {

// length_pct: the way from each posed frame to the next, added up, against that which the visual
// odometry of the same frames tells. Steps that are all too short alike contradict neither each
// other nor, within their noise, those of the odometry one by one; and a bent map may have equal
// left-right distances. No value for a way shorter than the baseline. `accuracy_pct` is what was
// asked of the scale. One pose a frame, where there is one.
Gate JudgeLength(const std::vector<std::optional<Rigid3>>& world_from_left,
                 const Odometry& odometry, double baseline_m, double accuracy_pct);

}  // namespace rigmap
