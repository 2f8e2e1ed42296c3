// The synthetic rover as COLMAP's input.
#pragma once

#include <string>

#include "colmap/database.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {

// Image ids: left of frame i is 2 i + 1, right 2 i + 2. Cameras 1 (left) and 2 (right).
inline std::uint32_t ImageId(int frame, Eye eye) {
  return static_cast<std::uint32_t>(2 * frame + 1 + static_cast<int>(eye));
}

// Stereo pairs and left images up to `neighbours` frames apart, with all true matches. Every
// second pair is given larger id first.
DatabaseContent RoverDatabase(const SyntheticRover& rover, int neighbours);

// Cameras and posed images of frames 0 to `frames` - 1 in the rover's world, no keypoints.
SparseModel RoverPoses(const SyntheticRover& rover, int frames);

}  // namespace rigmap
