// What moves through the world: the rover itself, as far as it is seen or casts a shadow, and a
// person.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/rigid3.h"
#include "simulation/mesh.h"
#include "simulation/ray_scene.h"

namespace rigmap {

// A rigid body in its own axes, ready to be drawn. Immutable once built.
struct Body {
  Mesh mesh;
  std::vector<Eigen::Vector3f> albedo;  // per vertex
  RayScene scene;                       // of the mesh alone
};

struct PosedBody {
  const Body* body = nullptr;
  Rigid3 world_from_body;
};

// The rover in body axes (x forward, y left, z up, on the ground): deck, mast, wheels; and one
// wheel on an arm so far ahead that its edge comes into the lower left corner of LocCam's view.
// Nothing is within 20 cm of the cameras.
std::unique_ptr<Body> MakeRoverBody();

// A person of 1.75 m who walks along x, feet at the origin; `stride` from 0 to 1 is a whole step.
std::unique_ptr<Body> MakePersonBody(double stride);

}  // namespace rigmap
