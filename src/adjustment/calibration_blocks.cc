#include "adjustment/internal/calibration_blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "adjustment/internal/point_inverse.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

// As few as can contradict each other, as far as there are frames for so many; else two frames
// each.
constexpr int kMostStretches = 8, kFewestStretches = 4;
constexpr int kRings = 4, kRegions = 2 * kRings;

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
  const Eigen::Matrix3d inverse = InverseOfPoint(v);
  block.score -= gradient - coupling * (inverse * v_gradient);
  const Eigen::Matrix<double, kCalibrationSize, 3> scaled = coupling * inverse;
  block.information += information - scaled.lazyProduct(coupling.transpose());
}

// Per point.
std::vector<int> StretchesOf(const std::vector<AdjustedPoint>& points,
                             const std::vector<std::optional<Rigid3>>& left_from_world,
                             int stretches, int posed) {
  std::vector<int> rank(left_from_world.size(), 0);
  for (std::size_t frame = 1; frame < rank.size(); ++frame) {
    rank[frame] = rank[frame - 1] + (left_from_world[frame - 1] ? 1 : 0);
  }
  std::vector<int> found;
  for (const AdjustedPoint& point : points) {
    found.push_back(rank[point.observations.front().frame] * stretches / posed);
  }
  return found;
}

// In the left image, from its principal point.
Eigen::Vector2d MeanOffset(const AdjustedPoint& point, const Camera& left) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const PointObservation& observation : point.observations) {
    if (observation.eye != Eye::kLeft) continue;
    sum += observation.pixel - Eigen::Vector2d(left.cx, left.cy);
    ++count;
  }
  return sum / std::max(count, 1);
}

// Per point.
std::vector<int> RegionsOf(const std::vector<AdjustedPoint>& points, const Camera& left) {
  std::vector<Eigen::Vector2d> offsets;
  std::vector<double> radii;
  for (const AdjustedPoint& point : points) {
    offsets.push_back(MeanOffset(point, left));
    radii.push_back(offsets.back().norm());
  }
  std::ranges::sort(radii);
  std::vector<int> found;
  for (const Eigen::Vector2d& offset : offsets) {
    int ring = 0;
    while (ring + 1 < kRings && offset.norm() >= radii[(ring + 1) * radii.size() / kRings]) ++ring;
    found.push_back(2 * ring + (offset.x() < 0.0 ? 0 : 1));
  }
  return found;
}

CalibrationBlock& operator+=(CalibrationBlock& sum, const CalibrationBlock& block) {
  sum.score += block.score;
  sum.information += block.information;
  return sum;
}

}  // namespace

CalibrationBlocks DivideCalibration(const std::vector<AdjustedPoint>& points,
                                    const std::vector<std::optional<Rigid3>>& left_from_world,
                                    const StereoRig& rig,
                                    const std::vector<PoseResponse>& responses, double noise_px,
                                    double huber_px) {
  const auto posed = static_cast<int>(
      std::ranges::count_if(left_from_world, [](const auto& pose) { return pose.has_value(); }));
  const int count =
      std::min(kMostStretches, std::max(posed / 2, std::min(posed, kFewestStretches)));
  if (count == 0) return {};
  const std::vector<int> stretches = StretchesOf(points, left_from_world, count, posed);
  const std::vector<int> regions = RegionsOf(points, rig.left.camera);
  std::vector<std::array<CalibrationBlock, kRegions>> cells(count);
  tbb::parallel_for(0, count, [&](int stretch) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (stretches[i] != stretch) continue;
      AddPoint(points[i], left_from_world, rig, responses, noise_px, huber_px,
               cells[stretch][regions[i]]);
    }
  });
  CalibrationBlocks blocks{std::vector<CalibrationBlock>(count),
                           std::vector<CalibrationBlock>(kRegions)};
  for (int stretch = 0; stretch < count; ++stretch) {
    for (int region = 0; region < kRegions; ++region) {
      blocks.stretches[stretch] += cells[stretch][region];
      blocks.regions[region] += cells[stretch][region];
    }
  }
  return blocks;
}

}  // namespace rigmap
