// Frames of which nothing is known but poses of others.
#pragma once

#include <optional>
#include <vector>

#include "scene/odometry.h"

namespace rigmap {

// An odometry that measured nothing: every frame is predicted, known poses stay as they are
// (metres, any gauge), those between two of them lie on the screw motion from one to the other, by
// time, those before the first and after the last stand where it does. Every frame is a keyframe.
// At least one pose must be there; stamps strictly increase. Covariances are not a number.
Odometry InterpolatedOdometry(const std::vector<StampNs>& stamps_ns,
                              const std::vector<std::optional<Rigid3>>& world_from_left);

}  // namespace rigmap
