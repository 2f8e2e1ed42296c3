// Depth by the disparity of one frame beside depth by motion, observation by observation.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scene/adjustment.h"

namespace rigmap {

// Along the ray of one left observation: the disparity that its right observation shows, less the
// one that belongs to the depth at which the left images of the other frames see the point.
struct DepthDifference {
  int track = 0;  // index of the point; differences of a track follow each other
  int frame = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the left image
  double disparity_px = 0.0;                        // by the temporal depth, from infinity on
  double difference_px = 0.0;                       // stereo less temporal
  double variance = 0.0;  // of the difference, in variances of one image coordinate
};

// Leaves the frame's own stereo match out of the temporal depth, and out of the comparison what the
// other frames know less well than the rig's baseline would.
std::vector<DepthDifference> CompareDepths(const Adjustment& adjustment);

}  // namespace rigmap
