// A part of which the odometry knows every step, for the tests of its trajectory.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "trajectory/assemble_trajectory.h"

namespace rigmap {

inline constexpr double kStepSigma_m = 0.01, kStepSigma_rad = 0.004;

inline Matrix6d Diagonal(double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

inline double Distance(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm();
}
inline double Angle(const Rigid3& a, const Rigid3& b) {
  return AngleOf(a.rotation.conjugate() * b.rotation);
}

inline void ExpectSame(const Rigid3& found, const Rigid3& expected, double tolerance = 1e-9) {
  EXPECT_LT(Distance(found, expected), tolerance);
  EXPECT_LT(Angle(found, expected), tolerance);
}

// A curved drive of which the odometry knows every step, each frame measured against the one
// before; nothing is adjusted but the first frame.
struct Part {
  explicit Part(int frames) {
    Rigid3 pose;
    for (int i = 0; i < frames; ++i) {
      OdometryFrame frame{.stamp_ns = 400'000'000LL * i, .world_from_left = pose};
      frame.reference = std::max(0, i - 1);
      frame.source = PoseSource::kOdometry;
      if (i > 0) frame.step_covariance = Diagonal(kStepSigma_m, kStepSigma_rad);
      odometry.push_back(frame);
      pose = pose * Rigid3{ExpRotation({0.01, 0.05, -0.02}), {0.02, -0.01, 0.3}};
    }
    adjustment.world_from_left.resize(frames);
    adjustment.covariances.resize(frames, Matrix6d::Zero());
    for (int i = 0; i < frames; ++i) adjustment.datum_frames.push_back(i);
    adjustment.world_from_left[0] = odometry[0].world_from_left;
  }

  void Adjust(int frame, const Rigid3& pose, const Matrix6d& covariance, int datum_frame = 0) {
    adjustment.world_from_left[frame] = pose;
    adjustment.covariances[frame] = covariance;
    adjustment.datum_frames[frame] = datum_frame;
  }
  // How well the adjustment tells each frame's motion from its reference.
  void TellLinks(const Matrix6d& covariance) {
    adjustment.link_covariances.assign(odometry.size(), covariance);
    adjustment.link_covariances[0].reset();
  }
  // Frames first to end - 1 were not measured; the one behind was, across the gap.
  void Predict(int first, int end) {
    for (int i = first; i < end; ++i) odometry[i].source = PoseSource::kPredicted;
    if (end < static_cast<int>(odometry.size())) odometry[end].reference = first - 1;
  }
  Trajectory Assemble(const Rigid3& world_from_gauge = {}) const {
    return AssembleTrajectory(odometry, adjustment, world_from_gauge);
  }
  Rigid3 Step(int from, int to) const {
    return odometry[from].world_from_left.Inverse() * odometry[to].world_from_left;
  }

  Odometry odometry;
  Adjustment adjustment;
};

}  // namespace rigmap
