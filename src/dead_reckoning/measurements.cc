#include "dead_reckoning/internal/measurements.h"

#include <algorithm>

namespace rigmap {
namespace {

Measurement Blank(const Belief& belief, int numbers) {
  return {Eigen::VectorXd::Zero(numbers), Eigen::MatrixXd::Zero(numbers, belief.Size()),
          Eigen::MatrixXd::Identity(numbers, numbers)};
}

}  // namespace

Measurement InclinationOf(const Belief& belief, const Eigen::Vector3d& acceleration_in_imu,
                          const RoverModel& model) {
  const RoverState& state = belief.rover;
  const Eigen::Matrix3d imu_from_gauge =
      (model.imu_from_left.rotation * state.gauge_from_left.rotation.conjugate())
          .toRotationMatrix();
  const Eigen::Vector3d level(state.values(kLevel), state.values(kLevel + 1), 0.0);
  const Eigen::Vector3d expected = ExpRotation(level) * (imu_from_gauge * state.up_in_gauge);
  Measurement measurement = Blank(belief, 3);
  measurement.residual = acceleration_in_imu.normalized() - expected;
  const Eigen::Matrix3d by_turn = imu_from_gauge * Skew(state.up_in_gauge);
  measurement.jacobian.block<3, 3>(0, kRotation) = by_turn;
  measurement.jacobian.block<3, 3>(0, kUp) = -by_turn;
  measurement.jacobian.block<3, 2>(0, kLevel) = -Skew(expected).leftCols<2>();
  const double sigma = model.options.inclinometer_sigma_rad;
  measurement.noise *= sigma * sigma;
  return measurement;
}

Measurement BiasAtRest(const Belief& belief, const MeanRate& rate, const RoverModel& model) {
  Measurement measurement = Blank(belief, 3);
  measurement.residual = rate.radps - belief.rover.values.segment<3>(kGyroBias);
  measurement.jacobian.block<3, 3>(0, kGyroBias).setIdentity();
  const double density = model.options.gyro_noise_radps;
  measurement.noise *= density * density / rate.duration_s;
  return measurement;
}

Measurement VisualMotionOf(const Belief& belief, const VisualStep& step, double noise_factor) {
  const auto clone = std::ranges::find(belief.clones, step.from, &ClonedPose::frame);
  const auto index = kStateSize + 6 * (clone - belief.clones.begin());
  const Rigid3 &from = clone->gauge_from_left, &to = belief.rover.gauge_from_left;
  const Eigen::Vector3d way = to.translation - from.translation;
  // Measured motion times the inverse of the expected one: none, but for errors.
  const Rigid3 off = step.to_from_from * (from.Inverse() * to);
  Measurement measurement = Blank(belief, 6);
  measurement.residual << -off.translation, -LogRotation(off.rotation);
  // As measured: what was predicted without a gyro may be off by much of a turn.
  const Eigen::Matrix3d to_from_gauge =
      (step.to_from_from.rotation * from.rotation.conjugate()).toRotationMatrix();
  auto& jacobian = measurement.jacobian;
  jacobian.block<3, 3>(0, kPosition) = to_from_gauge;
  jacobian.block<3, 3>(0, index) = -to_from_gauge;
  jacobian.block<3, 3>(0, index + 3) = to_from_gauge * Skew(way);
  jacobian.block<3, 3>(3, kRotation) = to_from_gauge;
  jacobian.block<3, 3>(3, index + 3) = -to_from_gauge;
  measurement.noise = noise_factor * step.covariance;
  return measurement;
}

Matrix6d CovarianceSince(int frame, const Belief& belief) {
  const auto clone = std::ranges::find(belief.clones, frame, &ClonedPose::frame);
  const Rigid3 motion = belief.rover.gauge_from_left.Inverse() * clone->gauge_from_left;
  const Eigen::MatrixXd jacobian =
      VisualMotionOf(belief, {.from = frame, .to_from_from = motion}, 1.0).jacobian;
  return jacobian * belief.covariance * jacobian.transpose();
}

}  // namespace rigmap
