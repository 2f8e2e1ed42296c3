// Where images and the rover's sensors tell of motions that cannot both be.
#pragma once

#include <optional>
#include <vector>

#include "dead_reckoning/dead_reckoning_options.h"
#include "scene/dataset.h"
#include "scene/odometry.h"

namespace rigmap {

struct Contradictions {
  std::vector<int> frames;  // to which images and sensors tell another way, in order
  int steps = 0;            // that images tell
};

// Of an odometry whose gaps are bridged: its steps that wheels and gyro contradict beyond their
// noise and any slip, and flatly: by half of the longer way and two centimetres, or a turn of 0.1
// rad. Units, radii or axes that are somewhat off do not make that; a camera that hung, or what
// moves along with the rover, does. Nothing where the rover has no wheels or gyro that can be used.
std::optional<Contradictions> FlatContradictions(const Dataset& dataset, const Odometry& odometry,
                                                 const DeadReckoningOptions& options,
                                                 const FilterOptions& filter);

}  // namespace rigmap
