// The smallest sample that tells a motion. Of this room only.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "correspondence/stereo_pose.h"

namespace rigmap {

// Up to four motions (current from reference) that carry three points onto their left sightings.
std::vector<Rigid3> ThreePointPoses(std::span<const PointSighting> sightings,
                                    const std::array<int, 3>& sample);

}  // namespace rigmap
