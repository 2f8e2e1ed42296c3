// The synthetic rover as COLMAP's input.
#pragma once

#include <string>

#include "colmap/database.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {

// Stereo pairs and left images up to `neighbours` frames apart, with all true matches. Every
// second pair is given the later image first.
DatabaseContent RoverDatabase(const SyntheticRover& rover, int neighbours);

// Cameras and posed images of frames 0 to `frames` - 1 in the rover's world, no keypoints.
SparseModel RoverPoses(const SyntheticRover& rover, int frames);

}  // namespace rigmap
