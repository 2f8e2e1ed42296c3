// A smaller image of the same view.
#pragma once

#include <cmath>

#include "scene/rig.h"

namespace rigmap {

// The camera with `share` as many pixels along each side, which see the same directions.
inline Camera Scaled(Camera camera, double share) {
  camera.width = static_cast<int>(std::lround(share * camera.width));
  camera.height = static_cast<int>(std::lround(share * camera.height));
  camera.fx *= share;
  camera.fy *= share;
  camera.cx = share * (camera.cx + 0.5) - 0.5;
  camera.cy = share * (camera.cy + 0.5) - 0.5;
  return camera;
}

inline StereoRig Scaled(StereoRig rig, double share) {
  rig.left.camera = Scaled(rig.left.camera, share);
  rig.right.camera = Scaled(rig.right.camera, share);
  return rig;
}

}  // namespace rigmap
