// Pose graphs as g2o reads them: "VERTEX_SE3:QUAT id x y z qx qy qz qw" for each node and
// "EDGE_SE3:QUAT a b x y z qx qy qz qw I11 I12 ... I66" for each edge.
#pragma once

#include <string>

#include "scene/pose_graph.h"

namespace rigmap {

// Vertices are world_from_left, ids the nodes' indices. An edge's measurement is a_from_b; its
// information, the upper triangle row by row, is of g2o's error: the translation (m), then the
// vector part of the unit quaternion (half the rotation vector) of the motion from the measured to
// the actual b, along b's measured axes. Equal graphs give equal bytes, whatever the locale.
std::string WriteG2o(const PoseGraph& graph);

}  // namespace rigmap
