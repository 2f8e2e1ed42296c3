#include "adjustment/internal/field_system.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "adjustment/internal/lens_field.h"
#include "adjustment/internal/point_inverse.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr std::size_t kFieldParts = 4;  // each has a matrix of its own

// A node of the field that a point's observations touch; `parameter` is its first.
struct TouchedNode {
  int parameter = 0;
  Eigen::Matrix<double, 2, 3> coupling = Eigen::Matrix<double, 2, 3>::Zero();  // with the point
};

// An unknown pose, or turn of a right eye, that sees a point.
struct SeeingPose {
  int unknown = 0;
  Eigen::Matrix<double, 6, 3> coupling = Eigen::Matrix<double, 6, 3>::Zero();
};

// One point, before it is eliminated.
struct FieldPoint {
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kCalibrationSize, 3> calibration =
      Eigen::Matrix<double, kCalibrationSize, 3>::Zero();
  std::vector<SeeingPose> poses;   // in order of frames
  std::vector<TouchedNode> nodes;  // in no order

  TouchedNode& NodeOf(int parameter) {
    const auto at = std::ranges::find(nodes, parameter, &TouchedNode::parameter);
    return at != nodes.end() ? *at : nodes.emplace_back(TouchedNode{.parameter = parameter});
  }
};

class FieldAssembly {
 public:
  FieldAssembly(const Linearisation& at, const ReducedSystem& system) : at_(at), system_(system) {
    const int size = at.field->Size();
    sum_.information = Eigen::MatrixXd::Zero(size, size);
    sum_.pose_coupling = Eigen::MatrixXd::Zero(6 * system.unknowns, size);
    sum_.calibration_coupling.setZero(kCalibrationSize, size);
    sum_.gradient = Eigen::VectorXd::Zero(size);
  }

  void Add(const AdjustedPoint& adjusted) {
    FieldPoint point;
    for (const PointObservation& o : adjusted.observations) AddObservation(o, adjusted.x, point);
    Eliminate(point);
  }

  FieldSystem Take() { return std::move(sum_); }

 private:
  // A residual falls by what the field moves the pixel by.
  void AddObservation(const PointObservation& o, const Eigen::Vector3d& x, FieldPoint& point) {
    const auto seen = Reproject(at_.rig, o.eye, *at_.left_from_world[o.frame], x);
    if (!seen) return;
    const Eigen::Vector2d residual = seen->pixel - o.pixel;
    const double weight = at_.WeightOf(residual);
    const ReprojectionJacobians& j = seen->jacobians;
    point.v += weight * j.point.transpose() * j.point;
    point.gradient += weight * j.point.transpose() * residual;
    point.calibration += weight * j.calibration.transpose() * j.point;
    const LensField::Support support = at_.field->At(o.eye, o.pixel);
    Couple(system_.unknown[o.frame], weight, j.pose, j.point, support, point);
    if (o.eye == Eye::kRight) {
      Couple(system_.turn[o.frame], weight, ByTurn(j), j.point, support, point);
    }
    for (int i = 0; i < 4; ++i) {
      const int column = support.parameter[i];
      const double share = weight * support.weight[i];
      point.NodeOf(column).coupling -= share * j.point;
      sum_.gradient.segment<2>(column) -= share * residual;
      sum_.calibration_coupling.middleCols<2>(column) -= share * j.calibration.transpose();
      for (int k = 0; k < 4; ++k) {
        sum_.information.block<2, 2>(column, support.parameter[k]).diagonal().array() +=
            share * support.weight[k];
      }
    }
  }

  void Couple(int unknown, double weight, const Eigen::Matrix<double, 2, 6>& by_unknown,
              const Eigen::Matrix<double, 2, 3>& by_point, const LensField::Support& support,
              FieldPoint& point) {
    if (unknown < 0) return;
    if (point.poses.empty() || point.poses.back().unknown != unknown) {
      point.poses.push_back({.unknown = unknown});
    }
    point.poses.back().coupling += weight * by_unknown.transpose() * by_point;
    for (int i = 0; i < 4; ++i) {
      sum_.pose_coupling.block<6, 2>(6 * unknown, support.parameter[i]) -=
          weight * support.weight[i] * by_unknown.transpose();
    }
  }

  void Eliminate(const FieldPoint& point) {
    const Eigen::Matrix3d inverse = InverseOfPoint(point.v);
    for (const TouchedNode& node : point.nodes) {
      const int column = node.parameter;
      const Eigen::Matrix<double, 3, 2> scaled = inverse * node.coupling.transpose();
      sum_.gradient.segment<2>(column) -= scaled.transpose() * point.gradient;
      sum_.calibration_coupling.middleCols<2>(column) -= point.calibration.lazyProduct(scaled);
      for (const SeeingPose& pose : point.poses) {
        sum_.pose_coupling.block<6, 2>(6 * pose.unknown, column) -= pose.coupling * scaled;
      }
      for (const TouchedNode& other : point.nodes) {
        sum_.information.block<2, 2>(other.parameter, column) -= other.coupling * scaled;
      }
    }
  }

  const Linearisation& at_;
  const ReducedSystem& system_;
  FieldSystem sum_;
};

}  // namespace

FieldSystem AssembleFieldSystem(const Linearisation& at, const ReducedSystem& system) {
  std::vector<FieldAssembly> parts(kFieldParts, FieldAssembly(at, system));
  tbb::parallel_for(std::size_t{0}, kFieldParts, [&](std::size_t i) {
    const std::size_t end = (i + 1) * at.points.size() / kFieldParts;
    for (std::size_t p = i * at.points.size() / kFieldParts; p < end; ++p) {
      parts[i].Add(at.points[p]);
    }
  });
  FieldSystem sum = parts.front().Take();
  for (std::size_t i = 1; i < kFieldParts; ++i) {
    const FieldSystem part = parts[i].Take();
    sum.information += part.information;
    sum.pose_coupling += part.pose_coupling;
    sum.calibration_coupling += part.calibration_coupling;
    sum.gradient += part.gradient;
  }
  return sum;
}

Eigen::MatrixXd FieldSolution::PoseSpread() const {
  return posterior.matrixL().solve(pose_by_field.transpose()).transpose();
}

FieldSolution SolveField(const Linearisation& at, FieldSystem field,
                         const Eigen::MatrixXd& solved_coupling,
                         const Eigen::MatrixXd& solved_calibration,
                         const Eigen::VectorXd& gradient) {
  FieldSolution solution;
  solution.information =
      std::move(field.information) - field.pose_coupling.transpose() * solved_coupling;
  solution.calibration_coupling =
      field.calibration_coupling - solved_calibration.transpose() * field.pose_coupling;
  solution.score = solved_coupling.transpose() * gradient - field.gradient;
  solution.pose_by_field = -solved_coupling;
  Eigen::MatrixXd with_prior = solution.information;
  with_prior.diagonal().array() += at.field_information;
  solution.posterior.compute(with_prior);
  solution.response.step = solution.posterior.solve(
      Eigen::VectorXd(solution.score - at.field_information * at.field->Values()));
  solution.response.by_calibration =
      -solution.posterior.solve(Eigen::MatrixXd(solution.calibration_coupling.transpose()));
  return solution;
}

}  // namespace rigmap
