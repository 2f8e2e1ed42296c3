// What the surface is made from, whichever technique gave the poses.
#pragma once

#include <string>
#include <vector>

#include "scene/adjustment.h"
#include "scene/dataset.h"
#include "scene/rig.h"
#include "scene/trajectory.h"
#include "scene/world_up.h"

namespace rigmap {

struct PosedPoint {
  Eigen::Vector3d x_in_world;
  std::vector<PointObservation> in_left;  // what left images show of it
};

// By frame, in the axes of its left camera, metres.
using PointsInLeft = std::vector<std::vector<Eigen::Vector3d>>;

struct PosedPart {
  StereoRig rig;  // as the part corrected it
  Trajectory trajectory;
  PointsInLeft points_in_left;     // sparse ones; empty where the technique has none
  std::vector<PosedPoint> points;  // those of the adjustment, once each; else empty
  WorldUp world_up = WorldUp::kCamera;
  // Per frame, of the right eye (Adjustment::right_turns); empty where the rig is stiff.
  std::vector<Eigen::Vector3d> right_turns = {};
};

// The rig with the files that go with it where they are now.
inline StereoRig WithFilesOf(const Dataset& dataset, StereoRig rig) {
  rig.source = dataset.rig.source;
  rig.left.mask_path = dataset.rig.left.mask_path;
  rig.right.mask_path = dataset.rig.right.mask_path;
  return rig;
}

}  // namespace rigmap
