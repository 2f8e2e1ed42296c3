#include "adjustment/internal/rig_flexure.h"

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "adjustment/calibration.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr int kFrameUnknowns = 9;  // a frame's pose, and the right eye's turn in it
using FrameMatrix = Eigen::Matrix<double, kFrameUnknowns, kFrameUnknowns>;
using FrameVector = Eigen::Matrix<double, kFrameUnknowns, 1>;

// Normal equations of one frame, its points held.
struct FrameSystem {
  FrameMatrix matrix = FrameMatrix::Zero();
  FrameVector gradient = FrameVector::Zero();
  int right_observations = 0;

  Eigen::Array3d Turn() const { return -matrix.ldlt().solve(gradient).tail<3>(); }
  // Of independent observations.
  Eigen::Array3d Variance() const { return matrix.inverse().diagonal().tail<3>(); }
};

// Of the points with even and with odd numbers.
using Halves = std::array<FrameSystem, 2>;

std::vector<Halves> HalvesOf(const Linearisation& at) {
  std::vector<Halves> frames(at.left_from_world.size());
  for (std::size_t i = 0; i < at.points.size(); ++i) {
    for (const PointObservation& o : at.points[i].observations) {
      const auto seen = Reproject(at.rig, o.eye, *at.left_from_world[o.frame], at.points[i].x);
      if (!seen) continue;
      Eigen::Matrix<double, 2, kFrameUnknowns> by;
      by << seen->jacobians.pose, seen->jacobians.calibration.middleCols<3>(kRotationX);
      const Eigen::Vector2d residual = seen->pixel - o.pixel;
      const double weight = at.WeightOf(residual);
      FrameSystem& half = frames[o.frame][i % 2];
      half.matrix += weight * by.transpose().lazyProduct(by);
      half.gradient += weight * by.transpose() * residual;
      if (o.eye == Eye::kRight) ++half.right_observations;
    }
  }
  return frames;
}

// What the halves of all frames ask for, about their means.
struct Agreement {
  double frames = 0.0, right_observations = 0.0;
  Eigen::Array3d even = Eigen::Array3d::Zero(), odd = even;  // variances
  Eigen::Array3d both = even;                                // covariance
  // Square by which a frame's halves differ, in units of what independent observations would.
  double apart = 0.0;
};

Agreement AgreementOf(const Linearisation& at) {
  constexpr int kMinRightObservations = 20;
  std::vector<Eigen::Array3d> even, odd;
  Eigen::Array3d expected = Eigen::Array3d::Zero();
  Agreement found;
  for (const auto& [a, b] : HalvesOf(at)) {
    if (std::min(a.right_observations, b.right_observations) < kMinRightObservations) continue;
    even.push_back(a.Turn());
    odd.push_back(b.Turn());
    expected += a.Variance() + b.Variance();
    found.right_observations += a.right_observations + b.right_observations;
  }
  found.frames = static_cast<double>(even.size());
  Eigen::Array3d mean_even = Eigen::Array3d::Zero(), mean_odd = mean_even;
  for (std::size_t i = 0; i < even.size(); ++i) {
    mean_even += even[i] / found.frames;
    mean_odd += odd[i] / found.frames;
  }
  for (std::size_t i = 0; i < even.size(); ++i) {
    const Eigen::Array3d e = even[i] - mean_even, o = odd[i] - mean_odd;
    found.even += e.square() / found.frames;
    found.odd += o.square() / found.frames;
    found.both += e * o / found.frames;
  }
  const Eigen::Array3d apart = found.even + found.odd - 2.0 * found.both;
  found.apart = (found.frames * apart / expected).mean();
  return found;
}

Eigen::Vector3d TurnStep(const PoseResponse& response, const CalibrationVector& calibration_step) {
  return response.turn_step + response.turn_by_calibration * calibration_step;
}

}  // namespace

Eigen::Vector2d RigFlexure::Steadied(const Camera& right, int frame,
                                     const Eigen::Vector2d& pixel) const {
  return IsFound() ? rigmap::Steadied(right, turns_[frame], pixel) : pixel;
}

bool RigFlexure::Begin(const Linearisation& at, const AdjustmentOptions& options) {
  constexpr double kMinFrames = 8.0;  // as many as a whole part has stretches
  constexpr double kChanceSigmas = 3.0;
  constexpr double kNeverTurns = 1e-9;  // rad
  const Agreement agreement = AgreementOf(at);
  if (agreement.frames < kMinFrames) return false;
  // What shared noise adds to that of a frame's mean, and so of the turns that make it: a roll
  // moves pixels by their distance from the middle.
  const Camera& right = at.rig.right.camera;
  const double focal = right.MeanFocal(), distance = right.RmsDistancePx();
  const double shared_px =
      at.noise_px * std::sqrt((options.shared_noise * options.shared_noise - 1.0) *
                              agreement.frames / agreement.right_observations);
  const Eigen::Array3d shared(shared_px / focal, shared_px / focal, shared_px / distance);
  for (int axis = 0; axis < 3; ++axis) {
    const double both = agreement.both(axis);
    const double chance = std::sqrt(agreement.even(axis) * agreement.odd(axis) / agreement.frames);
    const bool is_found = both > kChanceSigmas * chance && std::sqrt(both) > shared(axis);
    sigmas_(axis) = is_found ? std::sqrt(both) : 0.0;
  }
  if (sigmas_.isZero()) return false;
  information_ =
      std::max(1.0, agreement.apart) * sigmas_.cwiseMax(kNeverTurns).cwiseAbs2().cwiseInverse();
  turns_.assign(at.left_from_world.size(), Eigen::Vector3d::Zero());
  spdlog::info("the rig gives: the right eye turns from frame to frame by {:.3f} px",
               fmt::join(Eigen::Vector3d(focal * sigmas_), " "));
  return true;
}

void RigFlexure::Move(const std::vector<PoseResponse>& responses,
                      const CalibrationVector& calibration_step) {
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const Eigen::Vector3d step = TurnStep(responses[i], calibration_step);
    turns_[i] += (sigmas_.array() > 0.0).select(step, 0.0);  // the others' prior is no exact zero
  }
}

double RigFlexure::LargestStep(const std::vector<PoseResponse>& responses,
                               const CalibrationVector& calibration_step) {
  double largest = 0.0;
  for (const PoseResponse& response : responses) {
    largest = std::max(largest, TurnStep(response, calibration_step).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace rigmap
