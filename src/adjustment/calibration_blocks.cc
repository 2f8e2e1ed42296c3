#include "adjustment/internal/calibration_blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "adjustment/internal/point_inverse.h"
#include "adjustment/internal/rig_flexure.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

// As few as can contradict each other, as far as there are frames for so many; else two frames
// each.
constexpr int kMostStretches = 8, kFewestStretches = 4;
constexpr int kRings = 4, kRegions = 2 * kRings;

// Equations of one point, its position eliminated.
CalibrationBlock EquationsOf(const AdjustedPoint& point, const Linearisation& at,
                             const std::vector<PoseResponse>& poses, const FieldResponse& field) {
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
  Eigen::Vector3d v_gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kCalibrationSize, 3> coupling;
  coupling.setZero();
  CalibrationVector gradient = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Zero();
  for (const PointObservation& o : point.observations) {
    const auto seen = Reproject(at.rig, o.eye, *at.left_from_world[o.frame], point.x);
    if (!seen) continue;
    const PoseResponse& pose = poses[o.frame];
    const ReprojectionJacobians& j = seen->jacobians;
    Eigen::Vector2d residual = seen->pixel - o.pixel;
    const double weight = at.WeightOf(residual);
    residual += j.pose * pose.step;
    Eigen::Matrix<double, 2, kCalibrationSize> by_calibration =
        j.calibration + j.pose * pose.by_calibration;
    if (at.flexure != nullptr && o.eye == Eye::kRight) {
      const auto by_turn = j.calibration.middleCols<3>(kRotationX);
      residual += by_turn * pose.turn_step;
      by_calibration += by_turn * pose.turn_by_calibration;
    }
    if (at.field != nullptr) {
      const LensField::Support support = at.field->At(o.eye, o.pixel);
      residual -= at.field->Follow(support, field.step);
      by_calibration -= at.field->Follow(support, field.by_calibration);
    }
    v += weight * j.point.transpose() * j.point;
    v_gradient += weight * j.point.transpose() * residual;
    coupling += weight * by_calibration.transpose() * j.point;
    gradient += weight * by_calibration.transpose() * residual;
    // Lazily: products of this shape are too small for blocked ones to pay.
    information += weight * by_calibration.transpose().lazyProduct(by_calibration);
  }
  const Eigen::Matrix3d inverse = InverseOfPoint(v);
  const Eigen::Matrix<double, kCalibrationSize, 3> scaled = coupling * inverse;
  return {scaled * v_gradient - gradient, information - scaled.lazyProduct(coupling.transpose())};
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

int PosedCount(const Linearisation& at) {
  return static_cast<int>(
      std::ranges::count_if(at.left_from_world, [](const auto& pose) { return pose.has_value(); }));
}

// Of the posed frames before each frame.
std::vector<int> RanksOf(const Linearisation& at) {
  std::vector<int> rank(at.left_from_world.size(), 0);
  for (std::size_t frame = 1; frame < rank.size(); ++frame) {
    rank[frame] = rank[frame - 1] + (at.left_from_world[frame - 1] ? 1 : 0);
  }
  return rank;
}

// What the prior of its turn says of the calibration, which the turn follows.
CalibrationBlock EquationsOfTurn(const RigFlexure& flexure, std::size_t frame,
                                 const PoseResponse& response) {
  const Eigen::Matrix<double, kCalibrationSize, 3> weighed =
      response.turn_by_calibration.transpose() * flexure.Information().asDiagonal();
  return {-weighed * (flexure.Turns()[frame] + response.turn_step),
          weighed * response.turn_by_calibration};
}

// Each frame's to its stretch, and in equal shares to all regions.
void AddTurns(const Linearisation& at, const std::vector<PoseResponse>& responses,
              CalibrationBlocks& blocks) {
  const std::vector<int> ranks = RanksOf(at);
  const int posed = PosedCount(at);
  for (std::size_t frame = 0; frame < responses.size(); ++frame) {
    if (!at.left_from_world[frame]) continue;
    CalibrationBlock turn = EquationsOfTurn(*at.flexure, frame, responses[frame]);
    blocks.stretches[ranks[frame] * blocks.stretches.size() / posed] += turn;
    turn.score /= kRegions;
    turn.information /= kRegions;
    for (CalibrationBlock& region : blocks.regions) region += turn;
  }
}

}  // namespace

std::vector<int> StretchesOf(const Linearisation& at, int stretches) {
  const std::vector<int> rank = RanksOf(at);
  const int posed = PosedCount(at);
  std::vector<int> found;
  for (const AdjustedPoint& point : at.points) {
    found.push_back(rank[point.observations.front().frame] * stretches / posed);
  }
  return found;
}

int StretchCount(const Linearisation& at) {
  const int posed = PosedCount(at);
  return std::min(kMostStretches, std::max(posed / 2, std::min(posed, kFewestStretches)));
}

CalibrationBlocks DivideCalibration(const Linearisation& at, const std::vector<PoseResponse>& poses,
                                    const FieldResponse& field) {
  const int count = StretchCount(at);
  if (count == 0) return {};
  const std::vector<int> stretches = StretchesOf(at, count);
  const std::vector<int> regions = RegionsOf(at.points, at.rig.left.camera);
  std::vector<std::array<CalibrationBlock, kRegions>> cells(count);
  std::vector<CalibrationMatrix> score_covariances(count, CalibrationMatrix::Zero());
  tbb::parallel_for(0, count, [&](int stretch) {
    for (std::size_t i = 0; i < at.points.size(); ++i) {
      if (stretches[i] != stretch) continue;
      const CalibrationBlock point = EquationsOf(at.points[i], at, poses, field);
      cells[stretch][regions[i]] += point;
      score_covariances[stretch] += point.score * point.score.transpose();
    }
  });
  CalibrationBlocks blocks{std::vector<CalibrationBlock>(count),
                           std::vector<CalibrationBlock>(kRegions)};
  for (int stretch = 0; stretch < count; ++stretch) {
    for (int region = 0; region < kRegions; ++region) {
      blocks.stretches[stretch] += cells[stretch][region];
      blocks.regions[region] += cells[stretch][region];
    }
    blocks.score_covariance += score_covariances[stretch];
  }
  if (at.flexure != nullptr) AddTurns(at, poses, blocks);
  return blocks;
}

}  // namespace rigmap
