#include "adjustment/relax_poses.h"

#include <ceres/ceres.h>
#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>
#include <numeric>
#include <set>

#include "adjustment/reprojection_cost.h"

namespace rigmap {
namespace {

using Poses = std::vector<std::optional<Rigid3>>;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Sigmas of a step beside the odometry's own: what errs alike in all steps (calibration, far
// points) adds up to more than noise does. A hundred steps of 0.2 m may so be off by 0.1 m and 3
// degrees.
constexpr double kStepDriftShare = 0.05;
constexpr double kStepDrift_rad = 0.3 * kRadPerDeg;
// The sigmas that a pair's matches give their motion are too small by so much, since they err
// together: measured 1.3 (the same way again) to 3.3 (from another side).
constexpr double kRevisitInflation = 3.0;
// Of a revisit beside those: 1.5 px at 3 m for 840 px.
constexpr double kRevisitSigma_m = 0.005;
constexpr double kRevisitSigma_rad = 0.1 * kRadPerDeg;
// With it, a revisit cannot pull further than four sigmas of the steps in between.
constexpr double kCauchySigmas = 2.0;
constexpr double kMaxSigmas = 5.0;
// All revisits nearer than this (six pixels): bundle adjustment needs no help.
constexpr double kAgreeingSigmas = 4.0;

// A motion between two frames with the inverse root of its covariance (left perturbation,
// translation first).
struct Edge {
  int a = 0, b = 0;
  Rigid3 b_from_a;
  Matrix6d weight = Matrix6d::Identity();
};

Edge MakeEdge(int a, int b, const Rigid3& b_from_a, const Matrix6d& covariance, double sigma_m,
              double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  const Matrix6d together = covariance + Matrix6d(variances.asDiagonal());
  const Matrix6d root = together.llt().matrixL();
  return {a, b, b_from_a, root.triangularView<Eigen::Lower>().solve(Matrix6d::Identity())};
}

// The error of b_from_a in sigmas. Blocks: world_from_left of a and b. Twice the vector part of the
// rotation stands for its logarithm, which it is for all but gross errors.
struct EdgeError {
  template <class Scalar>
  bool operator()(const Scalar* world_from_a, const Scalar* world_from_b, Scalar* residual) const {
    using Quaternion = Eigen::Quaternion<Scalar>;
    using Vector = Eigen::Matrix<Scalar, 3, 1>;
    const Eigen::Map<const Quaternion> turn_a(world_from_a), turn_b(world_from_b);
    const Eigen::Map<const Vector> place_a(world_from_a + 4), place_b(world_from_b + 4);
    const Quaternion b_from_world = turn_b.conjugate();
    const Quaternion error =
        b_from_world * turn_a * edge.b_from_a.rotation.conjugate().template cast<Scalar>();
    const Scalar sign = error.w() < Scalar(0.0) ? Scalar(-1.0) : Scalar(1.0);
    Eigen::Matrix<Scalar, 6, 1> off;
    off << b_from_world * (place_a - place_b) -
               error * edge.b_from_a.translation.template cast<Scalar>(),
        Scalar(2.0) * sign * error.vec();
    Eigen::Map<Eigen::Matrix<Scalar, 6, 1>>{residual} = edge.weight.template cast<Scalar>() * off;
    return true;
  }
  Edge edge;
};

double Sigmas(const Edge& edge, const Poses& poses) {
  const MotionBlock a = ToBlock(*poses[edge.a]), b = ToBlock(*poses[edge.b]);
  Vector6d residual;
  EdgeError{edge}(a.data(), b.data(), residual.data());
  return residual.norm();
}

// Steps from each frame to the last one before it, in the chain of references, that has a pose.
std::vector<Edge> Steps(const Poses& poses, const Odometry& odometry) {
  std::vector<Edge> steps;
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    if (!poses[i]) continue;
    Matrix6d covariance = odometry[i].step_covariance;
    int from = odometry[i].reference;
    while (!poses[from] && odometry[from].reference != from) {
      covariance += odometry[from].step_covariance;
      from = odometry[from].reference;
    }
    if (from == i || !poses[from]) continue;
    const Rigid3 motion = poses[i]->Inverse() * *poses[from];
    steps.push_back(MakeEdge(from, i, motion, covariance,
                             kStepDriftShare * motion.translation.norm() + 1e-4, kStepDrift_rad));
  }
  return steps;
}

// The first frame of each group that edges hold together.
std::set<int> FirstOfGroups(const std::vector<Edge>& steps, const std::vector<Edge>& revisits,
                            std::size_t frames) {
  std::vector<int> first(frames);
  std::iota(first.begin(), first.end(), 0);
  for (bool joined = true; joined;) {
    joined = false;
    for (const auto* edges : {&steps, &revisits}) {
      for (const Edge& edge : *edges) {
        const int least = std::min(first[edge.a], first[edge.b]);
        joined = joined || first[edge.a] != least || first[edge.b] != least;
        first[edge.a] = first[edge.b] = least;
      }
    }
  }
  return {first.begin(), first.end()};
}

Poses Solve(const Poses& start, const std::vector<Edge>& steps, const std::vector<Edge>& revisits) {
  std::vector<MotionBlock> blocks;
  for (const auto& pose : start) blocks.push_back(ToBlock(pose.value_or(Rigid3())));
  ceres::Problem problem;
  const auto add = [&](const Edge& edge, ceres::LossFunction* loss) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EdgeError, 6, 7, 7>(new EdgeError{edge}), loss,
        blocks[edge.a].data(), blocks[edge.b].data());
  };
  for (const Edge& step : steps) add(step, nullptr);
  for (const Edge& revisit : revisits) add(revisit, new ceres::CauchyLoss(kCauchySigmas));
  const std::set<int> held = FirstOfGroups(steps, revisits, start.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!problem.HasParameterBlock(blocks[i].data())) continue;
    problem.SetManifold(
        blocks[i].data(),
        new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>());
    if (held.contains(static_cast<int>(i))) problem.SetParameterBlockConstant(blocks[i].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 200;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  spdlog::info("{}", summary.BriefReport());
  Poses solved = start;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (solved[i]) solved[i] = FromBlock(blocks[i].data());
  }
  return solved;
}

}  // namespace

std::vector<std::optional<Rigid3>> RelaxPoses(
    const std::vector<std::optional<Rigid3>>& world_from_left, const Odometry& odometry,
    const std::vector<Revisit>& revisits) {
  std::vector<Edge> edges;
  for (const Revisit& revisit : revisits) {
    if (!world_from_left[revisit.a] || !world_from_left[revisit.b]) continue;
    edges.push_back(MakeEdge(revisit.a, revisit.b, revisit.b_from_a,
                             kRevisitInflation * kRevisitInflation * revisit.covariance,
                             kRevisitSigma_m, kRevisitSigma_rad));
  }
  if (std::ranges::all_of(
          edges, [&](const Edge& e) { return Sigmas(e, world_from_left) <= kAgreeingSigmas; })) {
    return world_from_left;
  }
  const std::vector<Edge> steps = Steps(world_from_left, odometry);
  const Poses relaxed = Solve(world_from_left, steps, edges);
  const auto disbelieved =
      std::erase_if(edges, [&](const Edge& e) { return Sigmas(e, relaxed) > kMaxSigmas; });
  spdlog::info("{} revisits, {} of them not believed", edges.size() + disbelieved, disbelieved);
  if (disbelieved == 0) return relaxed;
  return edges.empty() ? world_from_left : Solve(world_from_left, steps, edges);
}

}  // namespace rigmap
