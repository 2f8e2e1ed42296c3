#include "adjustment/internal/reduced_system.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "adjustment/internal/datum_frames.h"
#include "adjustment/internal/point_inverse.h"
#include "adjustment/internal/rig_flexure.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr std::size_t kReducedParts = 16;

// Unknowns of a point: where it is, and the drift of its windows.
constexpr int kPointSize = 5;
using PointMatrix = Eigen::Matrix<double, kPointSize, kPointSize>;
using PointVector = Eigen::Matrix<double, kPointSize, 1>;

PointMatrix InverseWithDrift(const PointMatrix& information) {
  const Eigen::Matrix2d drift = information.bottomRightCorner<2, 2>().inverse();
  const Eigen::Matrix<double, 3, 2> following = information.topRightCorner<3, 2>() * drift;
  const Eigen::Matrix3d position =
      InverseOfPoint(information.topLeftCorner<3, 3>() -
                     following * information.topRightCorner<3, 2>().transpose());
  PointMatrix inverse;
  inverse << position, -position * following, -following.transpose() * position,
      drift + following.transpose() * position * following;
  return inverse;
}

// Of the ray from a frame's left eye to a point, in world axes, from that of the point's first one.
double Departure(const Eigen::Vector3d& first, const Eigen::Vector3d& ray) {
  const double angle = std::atan2(first.cross(ray).norm(), first.dot(ray));
  return std::hypot(angle, std::log(ray.norm() / first.norm()));
}

// One unknown pose, or turn of a right eye, that sees a point.
struct PointView {
  int unknown = 0;
  Eigen::Matrix<double, 6, kPointSize> coupling = Eigen::Matrix<double, 6, kPointSize>::Zero();
  Vector6d score = Vector6d::Zero();
};

// One point, before it is eliminated.
struct PointEquations {
  PointMatrix v = PointMatrix::Zero();
  PointVector gradient = PointVector::Zero();
  Eigen::Matrix<double, kCalibrationSize, kPointSize> calibration =
      Eigen::Matrix<double, kCalibrationSize, kPointSize>::Zero();
  CalibrationVector calibration_score = CalibrationVector::Zero();
  std::vector<PointView> views;  // in order of frames
};

Matrix6d& BlockOf(int row, int column, ReducedSystem& system) {
  return system.blocks.try_emplace({row, column}, Matrix6d::Zero()).first->second;
}

void AddObservation(const PointObservation& observation, const Eigen::Vector3d& x, double departure,
                    const Linearisation& at, PointEquations& point, ReducedSystem& system) {
  const auto seen = Reproject(at.rig, observation.eye, *at.left_from_world[observation.frame], x);
  if (!seen) return;
  const Eigen::Vector2d residual = seen->pixel - observation.pixel;
  const double weight = at.WeightOf(residual);
  const ReprojectionJacobians& j = seen->jacobians;
  Eigen::Matrix<double, 2, kPointSize> by_point;
  by_point << j.point, departure * Eigen::Matrix2d::Identity();
  point.v += weight * by_point.transpose() * by_point;
  point.gradient += weight * by_point.transpose() * residual;
  point.calibration += weight * j.calibration.transpose() * by_point;
  point.calibration_score += weight * j.calibration.transpose() * residual;
  // Lazily: products of this shape are too small for blocked ones to pay.
  system.calibration += weight * j.calibration.transpose().lazyProduct(j.calibration);
  const auto add = [&](int unknown, const Eigen::Matrix<double, 2, 6>& by_unknown) {
    if (unknown < 0) return;
    if (point.views.empty() || point.views.back().unknown != unknown) {
      point.views.push_back({.unknown = unknown});
    }
    PointView& view = point.views.back();
    view.coupling += weight * by_unknown.transpose() * by_point;
    view.score += weight * by_unknown.transpose() * residual;
    BlockOf(unknown, unknown, system) += weight * by_unknown.transpose() * by_unknown;
    system.pose_calibration[unknown] += weight * by_unknown.transpose().lazyProduct(j.calibration);
  };
  const int pose = system.unknown[observation.frame], turn = system.turn[observation.frame];
  add(pose, j.pose);
  if (turn < 0 || observation.eye == Eye::kLeft) return;
  const Eigen::Matrix<double, 2, 6> by_turn = ByTurn(j);
  add(turn, by_turn);
  if (pose >= 0) BlockOf(turn, pose, system) += weight * by_turn.transpose() * j.pose;
}

// Subtracts what the point's own freedom takes away.
void EliminatePoint(const PointEquations& point, const PointMatrix& inverse,
                    ReducedSystem& system) {
  for (const PointView& i : point.views) {
    const Eigen::Matrix<double, 6, kPointSize> scaled = i.coupling * inverse;
    for (const PointView& k : point.views) {
      if (k.unknown > i.unknown) break;
      BlockOf(i.unknown, k.unknown, system) -= scaled * k.coupling.transpose();
    }
    system.pose_calibration[i.unknown] -= scaled.lazyProduct(point.calibration.transpose());
    system.pose_gradient[i.unknown] -= scaled * point.gradient;
  }
  const Eigen::Matrix<double, kCalibrationSize, kPointSize> scaled = point.calibration * inverse;
  system.calibration -= scaled.lazyProduct(point.calibration.transpose());
  system.calibration_gradient -= scaled * point.gradient;
}

void AddCluster(const PointEquations& point, const PointMatrix& inverse, ReducedSystem& system) {
  const PointVector step = inverse * point.gradient;
  std::vector<ScoreClusters::Score> scores;
  for (const PointView& view : point.views) {
    scores.emplace_back(view.unknown, view.score - view.coupling * step);
  }
  system.clusters.Add(std::move(scores));
}

void AddPointTo(ReducedSystem& system, const AdjustedPoint& adjusted, const Linearisation& at) {
  PointEquations point;
  system.coordinates += 2.0 * static_cast<double>(adjusted.observations.size());
  system.point_unknowns += 3.0;
  const bool drifts = at.drift_sigma_px > 0.0;
  point.v.diagonal().tail<2>().setConstant(drifts ? std::pow(at.drift_sigma_px, -2) : 1.0);
  const auto ray_of = [&](const PointObservation& o) -> Eigen::Vector3d {
    return adjusted.x - at.left_from_world[o.frame]->Inverse().translation;
  };
  const PointObservation& first = adjusted.observations.front();
  for (const PointObservation& o : adjusted.observations) {
    const double departure =
        drifts && o.frame != first.frame ? Departure(ray_of(first), ray_of(o)) : 0.0;
    AddObservation(o, adjusted.x, departure, at, point, system);
  }
  for (const PointView& view : point.views) system.pose_gradient[view.unknown] += view.score;
  system.calibration_gradient += point.calibration_score;
  const PointMatrix inverse = InverseWithDrift(point.v);
  AddCluster(point, inverse, system);
  EliminatePoint(point, inverse, system);
}

ReducedSystem NumberUnknowns(const Linearisation& at) {
  const std::size_t frames = at.left_from_world.size();
  std::vector<bool> seen(frames, false);
  for (const AdjustedPoint& point : at.points) {
    for (const PointObservation& o : point.observations) seen[o.frame] = true;
  }
  ReducedSystem system{.datum_frames = DatumFrames(at.points, frames)};
  for (std::size_t i = 0; i < frames; ++i) {
    const bool is_held = !seen[i] || system.datum_frames[i] == static_cast<int>(i);
    system.unknown.push_back(is_held ? -1 : system.unknowns++);
    const bool turns = seen[i] && at.flexure != nullptr;
    system.turn.push_back(turns ? system.unknowns++ : -1);
    if (turns) ++system.turns;
  }
  system.pose_calibration.assign(system.unknowns, PoseCalibration::Zero());
  system.pose_gradient.assign(system.unknowns, Vector6d::Zero());
  return system;
}

// What the prior says of the turns.
void AddPrior(const RigFlexure& flexure, ReducedSystem& system) {
  for (std::size_t i = 0; i < system.turn.size(); ++i) {
    const int turn = system.turn[i];
    if (turn < 0) continue;
    Matrix6d& block = BlockOf(turn, turn, system);
    block.diagonal().head<3>() += flexure.Information();
    block.diagonal().tail<3>().array() += 1.0;
    system.pose_gradient[turn].head<3>() += flexure.Information().cwiseProduct(flexure.Turns()[i]);
  }
}

void AddUp(ReducedSystem part, ReducedSystem& sum) {
  for (const auto& [at, block] : part.blocks) BlockOf(at.first, at.second, sum) += block;
  for (int i = 0; i < sum.unknowns; ++i) {
    sum.pose_calibration[i] += part.pose_calibration[i];
    sum.pose_gradient[i] += part.pose_gradient[i];
  }
  sum.calibration += part.calibration;
  sum.calibration_gradient += part.calibration_gradient;
  sum.clusters.Append(std::move(part.clusters));
  sum.coordinates += part.coordinates;
  sum.point_unknowns += part.point_unknowns;
}

}  // namespace

double ReducedSystem::Redundancy() const {
  const double count = point_unknowns + 6.0 * (unknowns - turns) + 3.0 * turns;
  return std::max(0.1, 1.0 - count / std::max(coordinates, 1.0));
}

ReducedSystem AssembleReducedSystem(const Linearisation& at) {
  ReducedSystem sum = NumberUnknowns(at);
  std::vector<ReducedSystem> parts(kReducedParts, sum);
  tbb::parallel_for(std::size_t{0}, kReducedParts, [&](std::size_t i) {
    const std::size_t end = (i + 1) * at.points.size() / kReducedParts;
    for (std::size_t p = i * at.points.size() / kReducedParts; p < end; ++p) {
      AddPointTo(parts[i], at.points[p], at);
    }
  });
  for (ReducedSystem& part : parts) AddUp(std::move(part), sum);
  if (at.flexure != nullptr) AddPrior(*at.flexure, sum);
  return sum;
}

}  // namespace rigmap
