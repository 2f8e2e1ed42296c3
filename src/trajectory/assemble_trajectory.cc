#include "trajectory/assemble_trajectory.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <limits>

#include "geometry/carried_covariance.h"
#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

// A pose with the covariance of its translation and rotation (world axes), relative to the first,
// and what of its error comes of the calibration's.
struct Uncertain {
  Rigid3 gauge_from_left;
  Matrix6d covariance = Matrix6d::Zero();
  PoseCalibration by_calibration = PoseCalibration::Zero();
};

Matrix6d Unknown() { return Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()); }

Matrix6d Carry(const Uncertain& from, const Rigid3& gauge_from_left) {
  const Matrix6d carry = CarryMatrix(from.gauge_from_left, gauge_from_left);
  return carry * from.covariance * carry.transpose();
}

// Covariance of the end of a step, from that of its start and the step's own.
Matrix6d Chain(const Uncertain& reference, const Rigid3& gauge_from_left,
               const Matrix6d& step_covariance) {
  return Carry(reference, gauge_from_left) + Turned(step_covariance, gauge_from_left);
}

// A frame known relative to its datum frame, whose own uncertainty it shares. Both err as the same
// calibration does.
Uncertain BehindDatum(const Uncertain& datum, int i, const Adjustment& adjustment) {
  const Rigid3& pose = *adjustment.world_from_left[i];
  const Matrix6d carry = CarryMatrix(datum.gauge_from_left, pose);
  Uncertain behind{pose, carry * datum.covariance * carry.transpose() + adjustment.covariances[i]};
  if (adjustment.by_calibration.empty()) return behind;
  const PoseCalibration carried = carry * datum.by_calibration, &own = adjustment.by_calibration[i];
  const Matrix6d shared = carried * adjustment.calibration_covariance * own.transpose();
  behind.covariance += shared + shared.transpose();
  behind.by_calibration = carried + own;
  return behind;
}

// Indices of all frames, each after its reference frame: from the first posed one to the last, then
// from there back to the start.
std::vector<int> FromFirstPosed(const Odometry& odometry) {
  const int first = FirstPosedFrame(odometry), count = static_cast<int>(odometry.size());
  std::vector<int> order;
  for (int i = first; i < count; ++i) order.push_back(i);
  for (int i = first - 1; i >= 0; --i) order.push_back(i);
  return order;
}

// Of frame i, from the adjustment or from its reference frame, whose pose is known.
Uncertain PoseOf(int i, const Odometry& odometry, const Adjustment& adjustment,
                 const std::vector<Uncertain>& known) {
  const OdometryFrame& frame = odometry[i];
  const auto& adjusted = adjustment.world_from_left[i];
  if (adjusted && adjustment.datum_frames[i] != i) {
    if (adjustment.covariances.empty()) return {*adjusted, Unknown()};
    return BehindDatum(known[adjustment.datum_frames[i]], i, adjustment);
  }
  if (frame.reference == i) return {adjusted.value_or(frame.world_from_left)};
  const Uncertain& reference = known[frame.reference];
  const Rigid3 pose =
      adjusted.value_or(reference.gauge_from_left * OdometricStep(odometry, frame.reference, i));
  return {pose, Chain(reference, pose, frame.step_covariance),
          CarryMatrix(reference.gauge_from_left, pose) * reference.by_calibration};
}

double Seconds(StampNs from, StampNs to) { return 1e-9 * static_cast<double>(to - from); }

// How well the end of a predicted run is known relative to the frame before it: by what its own
// covariance has more than what it shares with that frame, or by the step that was measured across.
Matrix6d AcrossTheGap(const Uncertain& start, const Uncertain& end,
                      const OdometryFrame& end_frame) {
  const Matrix6d more = end.covariance - Carry(start, end.gauge_from_left);
  if (more.llt().info() == Eigen::Success) return more;
  return Turned(end_frame.step_covariance, end.gauge_from_left);
}

// Between two known ends, a predicted frame is as sure as both together make it. What the ends
// share counts once: the run is a chain of steps from the frame before it, whose end was measured.
void TieToEnd(const Odometry& odometry, int first, int end, std::vector<Uncertain>& poses) {
  const Uncertain &start = poses[first - 1], &known = poses[end];
  std::vector<Uncertain> chain{{start.gauge_from_left}};
  for (int i = first; i < end; ++i) {
    chain.push_back({poses[i].gauge_from_left,
                     Chain(chain.back(), poses[i].gauge_from_left, odometry[i].step_covariance)});
  }
  // Where the run itself would have put its end. The step that leaves the run is not known better
  // than those within it.
  const Rigid3 reached = poses[end - 1].gauge_from_left * OdometricStep(odometry, end - 1, end);
  const Matrix6d of_reached = Chain(chain.back(), reached, odometry[end - 1].step_covariance);
  const Matrix6d innovation = (of_reached + AcrossTheGap(start, known, odometry[end])).inverse();
  const Rigid3 known_from_reached = known.gauge_from_left * reached.Inverse();
  const double gap_s = Seconds(odometry[first - 1].stamp_ns, odometry[end].stamp_ns);
  for (int i = first; i < end; ++i) {
    const double share = Seconds(odometry[first - 1].stamp_ns, odometry[i].stamp_ns) / gap_s;
    const Rigid3 part = Interpolate(Rigid3(), known_from_reached, share);
    Uncertain& pose = poses[i];
    const Matrix6d& alone = chain[static_cast<std::size_t>(i - first) + 1].covariance;
    const Matrix6d to_end = CarryMatrix(pose.gauge_from_left, reached) * alone;
    const Matrix6d tied = alone - to_end.transpose() * innovation * to_end;
    const Matrix6d together = Carry(start, pose.gauge_from_left) + tied;
    if (together.allFinite()) pose.covariance = together;
    pose.gauge_from_left = part * pose.gauge_from_left;
  }
}

TimedPose ToWorld(const OdometryFrame& frame, const Uncertain& pose, bool adjusted,
                  const Rigid3& world_from_gauge) {
  const Eigen::Matrix3d turn = world_from_gauge.rotation.toRotationMatrix();
  const Matrix6d& covariance = pose.covariance;
  TimedPose timed{.stamp_ns = frame.stamp_ns};
  timed.world_from_left = world_from_gauge * pose.gauge_from_left;
  const auto sigmas = [&](const Eigen::Matrix3d& block) {
    return (turn * block * turn.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt().eval();
  };
  timed.sigmas << sigmas(covariance.topLeftCorner<3, 3>()),
      sigmas(covariance.bottomRightCorner<3, 3>());
  timed.position_covariance = turn * covariance.topLeftCorner<3, 3>() * turn.transpose();
  timed.source = adjusted ? PoseSource::kAdjusted : frame.source;
  timed.keyframe = frame.keyframe;
  return timed;
}

}  // namespace

Trajectory AssembleTrajectory(const Odometry& odometry, const Adjustment& adjustment,
                              const Rigid3& world_from_gauge) {
  const int count = static_cast<int>(odometry.size());
  std::vector<Uncertain> poses(odometry.size());
  for (const int i : FromFirstPosed(odometry)) poses[i] = PoseOf(i, odometry, adjustment, poses);
  for (int first = 1; first < count; ++first) {
    if (odometry[first].source != PoseSource::kPredicted || adjustment.world_from_left[first]) {
      continue;
    }
    int end = first;
    while (end < count && odometry[end].source == PoseSource::kPredicted &&
           !adjustment.world_from_left[end]) {
      ++end;
    }
    // Only a frame measured across the gap knows where its end is.
    if (end < count && odometry[end].reference < first) TieToEnd(odometry, first, end, poses);
    first = end;
  }
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    trajectory.push_back(ToWorld(odometry[i], poses[i], adjustment.world_from_left[i].has_value(),
                                 world_from_gauge));
  }
  return trajectory;
}

}  // namespace rigmap
