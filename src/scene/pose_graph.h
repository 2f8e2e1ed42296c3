// Poses and the measured motions that tie them together.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/stamp.h"
#include "geometry/rigid3.h"
#include "geometry/serialize.h"
#include "scene/trajectory.h"

namespace rigmap {

// What measured an edge. A seam joins two parts; a fix ties a pose to a node that stands for the
// frame in which a receiver measured it.
enum class PoseEdgeKind { kOdometry = 0, kLoopClosure = 1, kSeam = 2, kWheels = 3, kFix = 4 };

constexpr std::string_view Name(PoseEdgeKind kind) {
  switch (kind) {
    case PoseEdgeKind::kOdometry:
      return "odometry";
    case PoseEdgeKind::kLoopClosure:
      return "loop_closure";
    case PoseEdgeKind::kSeam:
      return "seam";
    case PoseEdgeKind::kWheels:
      return "wheels";
    case PoseEdgeKind::kFix:
      return "fix";
  }
  return "";
}

struct PoseNode {
  StampNs stamp_ns = 0;
  Rigid3 world_from_left;  // metres
  // Relative to the first node, along and about the world's axes: translation (m), rotation (rad).
  std::optional<Matrix6d> covariance;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, world_from_left, covariance);
  }
};

// A measured motion between two nodes (indices into PoseGraph::nodes). Its error is the left
// perturbation, in b's axes, that takes what was measured to what the nodes say: translation (m),
// then rotation (rad).
//
// The weight is kept as a root of the information, not as the information itself, since that is
// what least squares multiply errors with: taken apart and put together again it would not be the
// same to the last bit. Unlike a covariance it may also be singular, as a fix's is, which says
// nothing of rotation.
struct PoseEdge {
  int a = 0, b = 0;
  Rigid3 b_from_a;
  Matrix6d sqrt_information = Matrix6d::Identity();
  PoseEdgeKind kind = PoseEdgeKind::kOdometry;

  Matrix6d Information() const { return sqrt_information.transpose() * sqrt_information; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(a, b, b_from_a, sqrt_information, kind);
  }
};

struct PoseGraph {
  std::vector<PoseNode> nodes;
  std::vector<PoseEdge> edges;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(nodes, edges);
  }
};

// Inverse of the lower Cholesky factor. The covariance must be positive definite.
Matrix6d SqrtInformation(const Matrix6d& covariance);

// For every node the first of those that edges tie it to, directly or by way of others; itself for
// one without edges. How two groups lie to each other no edge tells.
std::vector<int> FirstOfGroups(const PoseGraph& graph);

}  // namespace rigmap
