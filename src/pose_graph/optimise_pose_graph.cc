#include "pose_graph/internal/optimise_pose_graph.h"

#include <ceres/ceres.h>
#include <spdlog/spdlog.h>

#include <vector>

#include "geometry/motion_block.h"

namespace rigmap {
namespace {

// The error of b_from_a in sigmas. Blocks: world_from_left of a and b.
struct EdgeError {
  template <class Scalar>
  bool operator()(const Scalar* world_from_a, const Scalar* world_from_b, Scalar* residual) const {
    using Quaternion = Eigen::Quaternion<Scalar>;
    using Vector = Eigen::Matrix<Scalar, 3, 1>;
    const Eigen::Map<const Quaternion> turn_a(world_from_a), turn_b(world_from_b);
    const Eigen::Map<const Vector> position_a(world_from_a + 4), position_b(world_from_b + 4);
    const Quaternion b_from_world = turn_b.conjugate();
    const Quaternion error =
        b_from_world * turn_a * b_from_a.rotation.conjugate().template cast<Scalar>();
    const Scalar sign = error.w() < Scalar(0.0) ? Scalar(-1.0) : Scalar(1.0);
    Eigen::Matrix<Scalar, 6, 1> off;
    off << b_from_world * (position_a - position_b) -
               error * b_from_a.translation.template cast<Scalar>(),
        Scalar(2.0) * sign * error.vec();
    Eigen::Map<Eigen::Matrix<Scalar, 6, 1>>{residual} = weight.template cast<Scalar>() * off;
    return true;
  }
  Rigid3 b_from_a;
  Matrix6d weight;
};

void AddEdges(const PoseGraph& graph, const PoseGraphOptions& options,
              std::vector<MotionBlock>& blocks, ceres::Problem& problem) {
  for (const PoseEdge& edge : graph.edges) {
    ceres::LossFunction* loss = edge.kind == PoseEdgeKind::kLoopClosure
                                    ? new ceres::CauchyLoss(options.closure_cauchy_sigmas)
                                    : nullptr;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7>(
                                 new EdgeError{edge.b_from_a, edge.sqrt_information}),
                             loss, blocks[edge.a].data(), blocks[edge.b].data());
  }
}

void HoldFirstOfGroups(const PoseGraph& graph, std::vector<MotionBlock>& blocks,
                       ceres::Problem& problem) {
  using PoseManifold =
      ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;
  const std::vector<int> first = FirstOfGroups(graph);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!problem.HasParameterBlock(blocks[i].data())) continue;
    problem.SetManifold(blocks[i].data(), new PoseManifold());
    if (first[i] == static_cast<int>(i)) problem.SetParameterBlockConstant(blocks[i].data());
  }
}

}  // namespace

PoseGraph OptimisePoseGraph(const PoseGraph& graph, const PoseGraphOptions& options) {
  std::vector<MotionBlock> blocks;
  for (const PoseNode& node : graph.nodes) blocks.push_back(ToBlock(node.world_from_left));
  ceres::Problem problem;
  AddEdges(graph, options, blocks, problem);
  HoldFirstOfGroups(graph, blocks, problem);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  spdlog::info("{}", summary.BriefReport());
  if (!summary.IsSolutionUsable()) {
    spdlog::warn("pose graph: no solution was found, its poses stay as they were");
    return graph;
  }
  PoseGraph solved = graph;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    solved.nodes[i].world_from_left = FromBlock(blocks[i].data());
    solved.nodes[i].covariance.reset();
  }
  return solved;
}

double ErrorSigmas(const PoseEdge& edge, const PoseGraph& graph) {
  const MotionBlock a = ToBlock(graph.nodes[edge.a].world_from_left),
                    b = ToBlock(graph.nodes[edge.b].world_from_left);
  Vector6d residual;
  EdgeError{edge.b_from_a, edge.sqrt_information}(a.data(), b.data(), residual.data());
  return residual.norm();
}

}  // namespace rigmap
