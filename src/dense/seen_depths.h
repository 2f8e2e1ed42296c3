// How far away the things are that a part saw.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scene/rig.h"

namespace rigmap {

// Depths along the left camera's axis, metres.
struct SeenDepths {
  double nearest_m = 0.0;  // nothing is nearer
  double near_m = 0.0;     // of near ground
};

// From each frame's sparse points in left camera axes. Nearer than half of the nearest of them (all
// but one in a thousand; rounded down) nothing is, as there would be sparse points on it; nor
// nearer than where a disparity is half the width of the image, since little of that is in both
// images. With fewer than a hundred points only the latter is known.
// Near ground is the median of what single frames say (NearDepth): by their keypoints, not by the
// sparse points, of which one technique keeps more far ones than another. Where no frame says it,
// it is taken to be ten times as far away as what both images show at all.
SeenDepths DepthsSeen(const StereoRig& rig,
                      const std::vector<std::vector<Eigen::Vector3d>>& points_in_left,
                      const std::vector<float>& near_of_frames_m);

// A cube to merge points in: a pixel's width on near ground or the sigma of its depth, whichever is
// more, so that few cubes stay empty and noise does not fill many; rounded up to 1 or 3 times a
// power of ten.
double VoxelFor(const StereoRig& rig, const SeenDepths& seen);

}  // namespace rigmap
