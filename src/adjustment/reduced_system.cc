#include "adjustment/internal/reduced_system.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "adjustment/internal/datum_frames.h"
#include "adjustment/internal/point_inverse.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr std::size_t kReducedParts = 16;

// One unknown pose that sees a point.
struct PointView {
  int unknown = 0;
  Eigen::Matrix<double, 6, 3> coupling = Eigen::Matrix<double, 6, 3>::Zero();
  Vector6d score = Vector6d::Zero();
};

// One point, before it is eliminated.
struct PointEquations {
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kCalibrationSize, 3> calibration =
      Eigen::Matrix<double, kCalibrationSize, 3>::Zero();
  CalibrationVector calibration_score = CalibrationVector::Zero();
  std::vector<PointView> views;  // in order of frames
};

Matrix6d& BlockOf(int row, int column, ReducedSystem& system) {
  return system.blocks.try_emplace({row, column}, Matrix6d::Zero()).first->second;
}

void AddObservation(const PointObservation& observation, const Eigen::Vector3d& x,
                    const Linearisation& at, PointEquations& point, ReducedSystem& system) {
  const auto seen = Reproject(at.rig, observation.eye, *at.left_from_world[observation.frame], x);
  if (!seen) return;
  const Eigen::Vector2d residual = seen->pixel - observation.pixel;
  const double weight = at.WeightOf(residual);
  const ReprojectionJacobians& j = seen->jacobians;
  point.v += weight * j.point.transpose() * j.point;
  point.gradient += weight * j.point.transpose() * residual;
  point.calibration += weight * j.calibration.transpose() * j.point;
  point.calibration_score += weight * j.calibration.transpose() * residual;
  // Lazily: products of this shape are too small for blocked ones to pay.
  system.calibration += weight * j.calibration.transpose().lazyProduct(j.calibration);
  const int unknown = system.unknown[observation.frame];
  if (unknown < 0) return;
  if (point.views.empty() || point.views.back().unknown != unknown) {
    point.views.push_back({.unknown = unknown});
  }
  PointView& view = point.views.back();
  view.coupling += weight * j.pose.transpose() * j.point;
  view.score += weight * j.pose.transpose() * residual;
  BlockOf(unknown, unknown, system) += weight * j.pose.transpose() * j.pose;
  system.pose_calibration[unknown] += weight * j.pose.transpose().lazyProduct(j.calibration);
}

// Subtracts what the point's own freedom takes away.
void EliminatePoint(const PointEquations& point, const Eigen::Matrix3d& inverse,
                    ReducedSystem& system) {
  for (const PointView& i : point.views) {
    const Eigen::Matrix<double, 6, 3> scaled = i.coupling * inverse;
    for (const PointView& k : point.views) {
      if (k.unknown > i.unknown) break;
      BlockOf(i.unknown, k.unknown, system) -= scaled * k.coupling.transpose();
    }
    system.pose_calibration[i.unknown] -= scaled.lazyProduct(point.calibration.transpose());
    system.pose_gradient[i.unknown] -= scaled * point.gradient;
  }
  const Eigen::Matrix<double, kCalibrationSize, 3> scaled = point.calibration * inverse;
  system.calibration -= scaled.lazyProduct(point.calibration.transpose());
  system.calibration_gradient -= scaled * point.gradient;
}

void AddCluster(const PointEquations& point, const Eigen::Matrix3d& inverse,
                ReducedSystem& system) {
  const Eigen::Vector3d step = inverse * point.gradient;
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
  for (const PointObservation& o : adjusted.observations) {
    AddObservation(o, adjusted.x, at, point, system);
  }
  for (const PointView& view : point.views) system.pose_gradient[view.unknown] += view.score;
  system.calibration_gradient += point.calibration_score;
  const Eigen::Matrix3d inverse = InverseOfPoint(point.v);
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
  }
  system.pose_calibration.assign(system.unknowns, PoseCalibration::Zero());
  system.pose_gradient.assign(system.unknowns, Vector6d::Zero());
  return system;
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
  const double count = point_unknowns + 6.0 * static_cast<double>(unknowns);
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
  return sum;
}

}  // namespace rigmap
