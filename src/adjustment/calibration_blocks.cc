#include "adjustment/internal/calibration_blocks.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>

#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr int kBlocks = 8;

// Equations of one point, its position eliminated.
void AddPoint(const AdjustedPoint& point, const std::vector<std::optional<Rigid3>>& left_from_world,
              const StereoRig& rig, const std::vector<PoseResponse>& responses, double noise_px,
              double huber_px, CalibrationBlock& block) {
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
  Eigen::Vector3d v_gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kCalibrationSize, 3> coupling;
  coupling.setZero();
  CalibrationVector gradient = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();
  for (const PointObservation& observation : point.observations) {
    const auto at = Reproject(rig, observation.eye, *left_from_world[observation.frame], point.x);
    if (!at) continue;
    const PoseResponse& response = responses[observation.frame];
    Eigen::Vector2d residual = at->pixel - observation.pixel;
    const double weight =
        std::min(1.0, huber_px / std::max(residual.norm(), 1e-9)) / (noise_px * noise_px);
    residual += at->jacobians.pose * response.step;
    const Eigen::Matrix<double, 2, kCalibrationSize> by_calibration =
        at->jacobians.calibration + at->jacobians.pose * response.by_calibration;
    v += weight * at->jacobians.point.transpose() * at->jacobians.point;
    v_gradient += weight * at->jacobians.point.transpose() * residual;
    coupling += weight * by_calibration.transpose() * at->jacobians.point;
    gradient += weight * by_calibration.transpose() * residual;
    // Lazily: products of this shape are too small for blocked ones to pay.
    information += weight * by_calibration.transpose().lazyProduct(by_calibration);
  }
  const Eigen::Matrix3d inverse = v.inverse();
  if (!inverse.allFinite()) return;
  block.score -= gradient - coupling * (inverse * v_gradient);
  const Eigen::Matrix<double, kCalibrationSize, 3> scaled = coupling * inverse;
  block.information += information - scaled.lazyProduct(coupling.transpose());
}

}  // namespace

std::vector<CalibrationBlock> CalibrationBlocks(
    const std::vector<AdjustedPoint>& points,
    const std::vector<std::optional<Rigid3>>& left_from_world, const StereoRig& rig,
    const std::vector<PoseResponse>& responses, double noise_px, double huber_px) {
  std::vector<int> rank(left_from_world.size(), 0);
  int posed = 0;
  for (std::size_t frame = 0; frame < rank.size(); ++frame) {
    rank[frame] = posed;
    if (left_from_world[frame]) ++posed;
  }
  const int count = std::min(kBlocks, posed / 2);
  std::vector<CalibrationBlock> blocks(static_cast<std::size_t>(std::max(count, 0)));
  if (blocks.empty()) return blocks;
  tbb::parallel_for(0, count, [&](int block) {
    for (const AdjustedPoint& point : points) {
      if (rank[point.observations.front().frame] * count / posed != block) continue;
      AddPoint(point, left_from_world, rig, responses, noise_px, huber_px, blocks[block]);
    }
  });
  return blocks;
}

}  // namespace rigmap
