// Which frames of a part its map is made of.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/camera.h"
#include "scene/trajectory.h"

namespace rigmap {

struct PosedFrames {
  const Trajectory& trajectory;
  const Camera& camera;  // the left one
  // By frame, sparse ones in left camera axes, metres.
  const std::vector<std::vector<Eigen::Vector3d>>& points_in_left;
  const std::vector<int>& unreadable;  // increasing
};

// Indices, increasing: keyframes, and of the frames between them as many as it takes for what
// passes the image fastest (of a keyframe's points all but a tenth pass more slowly) to be seen by
// kViewsOfFastest of them, and the last one. Standing still adds none. All frames where fewer than
// kFewKeyframes are keyframes.
// None that cannot be read; none that is posed by odometry alone, or predicted, with sigmas
// relative to the first frame, or of those between to the keyframe before it, that a map of such
// voxels would show. `near_m`: distance of near ground, where a rotation's sigma counts.
inline constexpr double kViewsOfFastest = 9.0;  // as many as fusion compares with one another
inline constexpr int kFewKeyframes = 3;
std::vector<int> FramesForDepth(const PosedFrames& frames, double near_m, double voxel_m);

}  // namespace rigmap
