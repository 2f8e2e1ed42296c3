// Depth maps of flat ground, as a small stereo rig that drives over it would find them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "imaging/depth_map.h"
#include "tests/support/seeded_random.h"

namespace rigmap {

// Parallel to the ground z = 0, seen from above.
struct Plate {
  Eigen::Vector2d least, most;  // its corners, metres in world
  double height_m = 0.0;
};

struct GroundView {
  double noise_px = 0.0;   // of the disparities
  double sigma_px = 0.25;  // that the map states
  std::optional<Plate> plate;
};

// A camera 1.1 m above the ground that looks 30 degrees down and drives along x, swaying a little.
Rigid3 WorldFromLeft(double x_m);

// 320 x 240 px, 260 px focal length, 0.12 m baseline, up to 4 m away, rectified axes turned a
// little against the camera's. All has the colour (10, 20, 30).
DepthMap GroundSeenFrom(const Rigid3& world_from_left, const GroundView& view,
                        SeededRandom& random);

}  // namespace rigmap
