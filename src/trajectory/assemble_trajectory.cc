#include "trajectory/assemble_trajectory.h"

#include <Eigen/LU>

#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

// A pose with the covariance of its translation and rotation (world axes), relative to the first.
struct Uncertain {
  Rigid3 gauge_from_left;
  Matrix6d covariance = Matrix6d::Zero();
};

// The covariance of a pose (about gauge axes) propagated to another pose that is rigidly connected
// to it: a rotation of the first moves the second by the lever arm between them.
Matrix6d Carry(const Uncertain& from, const Rigid3& gauge_from_left) {
  Matrix6d carry = Matrix6d::Identity();
  carry.topRightCorner<3, 3>() =
      -Skew(gauge_from_left.translation - from.gauge_from_left.translation);
  return carry * from.covariance * carry.transpose();
}

// Covariance of the end of a step, from that of its start (about gauge axes) and the step's own
// (left perturbation of left_from_reference, current axes).
Matrix6d Chain(const Uncertain& reference, const Rigid3& gauge_from_left,
               const Matrix6d& step_covariance) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      gauge_from_left.rotation.toRotationMatrix();
  return Carry(reference, gauge_from_left) + turn * step_covariance * turn.transpose();
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
    // Known relative to its datum frame, whose own uncertainty it shares.
    return {*adjusted,
            Carry(known[adjustment.datum_frames[i]], *adjusted) + adjustment.covariances[i]};
  }
  if (frame.reference == i) return {adjusted.value_or(frame.world_from_left)};
  const Uncertain& reference = known[frame.reference];
  const Rigid3 pose =
      adjusted.value_or(reference.gauge_from_left * OdometricStep(odometry, frame.reference, i));
  return {pose, Chain(reference, pose, frame.step_covariance)};
}

double Seconds(StampNs from, StampNs to) { return 1e-9 * static_cast<double>(to - from); }

// Between two known ends, a predicted frame is as sure as both together make it.
void TieToEnd(const Odometry& odometry, int first, int end, std::vector<Uncertain>& poses) {
  const Uncertain& known = poses[end];
  // Where the run itself would have put its end.
  const Rigid3 reached = poses[end - 1].gauge_from_left * OdometricStep(odometry, end - 1, end);
  const Rigid3 known_from_reached = known.gauge_from_left * reached.Inverse();
  const double gap_s = Seconds(odometry[first - 1].stamp_ns, odometry[end].stamp_ns);
  Matrix6d back = Matrix6d::Zero();
  std::vector<Matrix6d> from_end(static_cast<std::size_t>(end - first));
  for (int i = end - 1; i >= first; --i) {
    // The step that leaves the run is not known better than those within it.
    back += odometry[i].step_covariance;
    from_end[static_cast<std::size_t>(i - first)] = known.covariance + back;
  }
  for (int i = first; i < end; ++i) {
    const double share = Seconds(odometry[first - 1].stamp_ns, odometry[i].stamp_ns) / gap_s;
    const Rigid3 part = Interpolate(Rigid3(), known_from_reached, share);
    Uncertain& pose = poses[i];
    pose.gauge_from_left = part * pose.gauge_from_left;
    const Matrix6d information =
        pose.covariance.inverse() + from_end[static_cast<std::size_t>(i - first)].inverse();
    const Matrix6d together = information.inverse();
    if (together.allFinite()) pose.covariance = together;
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
