#include "pose_graph/part_graph.h"

#include <numbers>

namespace rigmap {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Sigmas of a step beside the odometry's own: what errs alike in all steps (calibration, far
// points) adds up to more than noise does. A hundred steps of 0.2 m may so be off by 0.1 m and 3
// degrees.
constexpr double kStepDriftShare = 0.05;
constexpr double kStepDrift_rad = 0.3 * kRadPerDeg;
// The sigmas that a pair's matches give their motion are too small by so much, since they err
// together: measured 1.3 (the same way again) to 3.3 (from another side).
constexpr double kLoopClosureInflation = 3.0;
// Of a loop closure beside those: 1.5 px at 3 m for 840 px.
constexpr double kLoopClosureSigma_m = 0.005;
constexpr double kLoopClosureSigma_rad = 0.1 * kRadPerDeg;

Matrix6d Widened(const Matrix6d& covariance, double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return covariance + Matrix6d(variances.asDiagonal());
}

PoseEdge OdometricStep(int from, int to, const Rigid3& to_from_from, const Matrix6d& covariance) {
  const Matrix6d widened =
      Widened(covariance, kStepDriftShare * to_from_from.translation.norm() + 1e-4, kStepDrift_rad);
  return {from, to, to_from_from, SqrtInformation(widened), PoseEdgeKind::kOdometry};
}

PoseEdge AdjustedStep(int from, int to, const Rigid3& to_from_from, const Matrix6d& covariance) {
  constexpr double kLeast_m = 1e-6, kLeast_rad = 1e-7;  // keeps it invertible
  const Matrix6d widened = Widened(covariance, kLeast_m, kLeast_rad);
  return {from, to, to_from_from, SqrtInformation(widened), PoseEdgeKind::kOdometry};
}

PoseEdge LoopClosureEdge(int a, int b, const LoopClosure& loop_closure) {
  const Matrix6d widened =
      Widened(kLoopClosureInflation * kLoopClosureInflation * loop_closure.covariance,
              kLoopClosureSigma_m, kLoopClosureSigma_rad);
  return {a, b, loop_closure.b_from_a, SqrtInformation(widened), PoseEdgeKind::kLoopClosure};
}

}  // namespace

PartGraph BuildPartGraph(const std::vector<std::optional<Rigid3>>& world_from_left,
                         const Odometry& odometry, const std::vector<LoopClosure>& loop_closures,
                         const std::vector<std::optional<Matrix6d>>& adjusted_steps) {
  PartGraph part;
  const int frames = static_cast<int>(world_from_left.size());
  std::vector<int> node(world_from_left.size(), 0);  // of each posed frame
  for (int i = 0; i < frames; ++i) {
    if (!world_from_left[i]) continue;
    node[i] = static_cast<int>(part.frames.size());
    part.frames.push_back(i);
    part.graph.nodes.push_back({odometry[i].stamp_ns, *world_from_left[i], {}});
  }
  for (const int i : part.frames) {
    Matrix6d covariance = odometry[i].step_covariance;
    int from = odometry[i].reference;
    while (!world_from_left[from] && odometry[from].reference != from) {
      covariance += odometry[from].step_covariance;
      from = odometry[from].reference;
    }
    if (from == i || !world_from_left[from]) continue;
    const Rigid3 motion = world_from_left[i]->Inverse() * *world_from_left[from];
    const bool is_adjusted =
        !adjusted_steps.empty() && adjusted_steps[i] && from == odometry[i].reference;
    part.graph.edges.push_back(is_adjusted
                                   ? AdjustedStep(node[from], node[i], motion, *adjusted_steps[i])
                                   : OdometricStep(node[from], node[i], motion, covariance));
  }
  for (const LoopClosure& loop_closure : loop_closures) {
    if (!world_from_left[loop_closure.a] || !world_from_left[loop_closure.b]) continue;
    part.graph.edges.push_back(
        LoopClosureEdge(node[loop_closure.a], node[loop_closure.b], loop_closure));
  }
  return part;
}

}  // namespace rigmap
