// Which way is up.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/dataset.h"
#include "scene/world_up.h"

namespace rigmap {

struct LevelledWorld {
  Rigid3 world_from_gauge;
  WorldUp up_source = WorldUp::kCamera;
};

// The world of the output: origin at the left camera of the first posed frame, z up, x the
// horizontal heading of that camera. Up is the mean measured acceleration where the rig knows its
// inclinometer; else the normal of the plane that most points lie on, if it is within 45 degrees of
// the cameras' -y and holds a third of them; else the first camera's -y.
// `gauge_from_left`: poses of the dataset's frames; at least one must be there.
LevelledWorld LevelWorld(const std::vector<std::optional<Rigid3>>& gauge_from_left,
                         std::span<const Eigen::Vector3d> points_in_gauge, const Dataset& dataset);

}  // namespace rigmap
