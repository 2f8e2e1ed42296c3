// Clouds of a surface with relief, as a camera above it would have them.
#pragma once

#include "geometry/rigid3.h"
#include "registration/frame_cloud.h"

namespace rigmap {

// Height of the surface above the plane that it waves about, metres.
double ReliefAt(double x, double y, double relief_m);

// A pose 1.2 m above the origin, moved by so much, its camera 40 degrees down; x is ahead.
Rigid3 WorldFromLeft(double ahead_m, double turn_rad = 0.0);

// What is 0.8 to 4 m ahead of the camera, a point every 5 cm, off the surface along its ray by
// noise. Which points differs from seed to seed.
FrameCloud SeenFrom(const Rigid3& world_from_left, double relief_m, double noise_m, unsigned seed);

}  // namespace rigmap
