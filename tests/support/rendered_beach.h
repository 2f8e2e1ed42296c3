// Images of a stereo rover on a textured relief, rendered without any error but rounding to 8 bit:
// pixels in, poses and surface known.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/rig.h"

namespace rigmap {

struct RenderedBeachOptions {
  int frames = 8;
  double step_m = 0.3;          // travelled between frames
  double turn_rad_per_m = 0.1;  // to the left
};

// A small rig like a rover's: 320 x 240, 260 px, distorted, 12 cm baseline, the right eye turned
// by a third of a degree.
StereoRig RenderedRig();

// Height of the ground (m) at a place of the world, whose z points up. The cameras are about 1.1 m
// above zero, the relief is 0.15 m high.
double GroundHeight(double x_m, double y_m);

// One world_from_left per frame; the rover pitches, rolls and heaves a little.
std::vector<Rigid3> RenderedPoses(const RenderedBeachOptions& options = {});

// Writes a whole stereo folder: left/ and right/ (grey PNG), times.txt, calib.yaml and
// groundtruth_tum.txt. Takes about half a second a frame on one core.
// Equal options give equal bytes.
void WriteRenderedBeach(const std::filesystem::path& folder,
                        const RenderedBeachOptions& options = {});

}  // namespace rigmap
