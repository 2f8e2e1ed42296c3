#include "dead_reckoning/internal/rover_state.h"

#include <cmath>

namespace rigmap {
namespace {

// Slip keeps its value over about so much of the way.
constexpr double kSlipLength_m = 1.0;
// What of slip stays for longer, as a share of slip_noise.
constexpr double kLastingShare = 0.1;
// Wheels that turn a rover on the spot scrub over about so much ground in a radian.
constexpr double kScrub_m = 0.3;
// Without a wheel's word, how much of the unknown motion is off the direction of travel.
constexpr double kUnknownAside = 0.2;
// Below what any sensor tells: keeps covariances regular.
constexpr double kLeastStep_m = 1e-4, kLeastStep_rad = 1e-5;

double Squared(double x) { return x * x; }

double Duration(const SensorSteps& steps) {
  double duration_s = 0.0;
  for (const SensorStep& step : steps) duration_s += step.duration_s;
  return duration_s;
}

// Direction of travel in IMU axes, and how it answers to the two angles of kTravel.
struct Travel {
  Eigen::Vector3d in_imu;
  Eigen::Matrix<double, 3, 2> by_angles;
};
Travel TravelOf(const RoverState& state) {
  const auto angles = state.values.segment<2>(kTravel);
  Travel travel;
  travel.in_imu = ExpRotation({0.0, angles(0), angles(1)}) * -Eigen::Vector3d::UnitX();
  travel.by_angles = -Skew(travel.in_imu).rightCols<2>();
  return travel;
}

// Moves a prediction on, step by step.
class Mover {
 public:
  Mover(const RoverState& state, const SensorSteps& steps, const CarriedMotion& carried,
        const RoverModel& model)
      : model_(model),
        carried_(carried),
        duration_s_(Duration(steps)),
        travel_(TravelOf(state)),
        lever_in_imu_(model.imu_from_left.translation - model.contact_in_imu -
                      state.values.segment<3>(kContact)) {
    prediction_.state = state;
  }

  void Move(const SensorStep& step) {
    RoverState& state = prediction_.state;
    const double gyro_scale = 1.0 + state.values(kGyroScale);
    const Eigen::Vector3d rate =
        step.turn_rate_radps
            ? (gyro_scale * (*step.turn_rate_radps - state.values.segment<3>(kGyroBias))).eval()
            : carried_.turn_radps;
    const Eigen::Quaterniond before =
        state.gauge_from_left.rotation * model_.imu_from_left.rotation.conjugate();
    const Eigen::Quaterniond middle = before * ExpRotation(0.5 * step.duration_s * rate);
    const Eigen::Quaterniond after = (before * ExpRotation(step.duration_s * rate)).normalized();
    const double way_m = std::exp(state.values(kWheelScale)) *
                         step.way_m.value_or(carried_.speed_mps * step.duration_s);
    const Eigen::Vector3d direction = middle * travel_.in_imu, way = way_m * direction;
    const Eigen::Vector3d lever_before = before * lever_in_imu_, lever = after * lever_in_imu_;
    state.gauge_from_left.translation += way + lever - lever_before;
    state.gauge_from_left.rotation = after * model_.imu_from_left.rotation;
    prediction_.way_in_gauge += way;

    StateMatrix move = StateMatrix::Identity();
    const Eigen::Matrix3d turn = middle.toRotationMatrix();
    if (step.turn_rate_radps) {
      move.block<3, 3>(kRotation, kGyroBias) = -step.duration_s * gyro_scale * turn;
      move.block<3, 1>(kRotation, kGyroScale) = step.duration_s / gyro_scale * (turn * rate);
    }
    // The camera's lever turns with the rotation after the step, the way with that before.
    move.middleRows<3>(kPosition) -= Skew(lever) * move.middleRows<3>(kRotation);
    move.block<3, 3>(kPosition, kRotation) += Skew(lever_before - way);
    move.block<3, 3>(kPosition, kContact) = (before.toRotationMatrix() - after.toRotationMatrix());
    if (step.way_m) {
      move.block<3, 1>(kPosition, kWheelScale) = way;
      move.block<3, 2>(kPosition, kTravel) = way_m * turn * travel_.by_angles;
    }
    prediction_.transition = move * prediction_.transition;
    AddNoise(step, rate, direction, lever, move.topLeftCorner<6, 6>());
  }

  Prediction Finish() {
    StateMatrix& noise = prediction_.noise;
    noise.topLeftCorner<6, 6>() = pose_noise_;
    noise.diagonal().segment<3>(kPosition).array() += Squared(kLeastStep_m);
    noise.diagonal().segment<3>(kRotation).array() += Squared(kLeastStep_rad);
    noise.diagonal().segment<3>(kGyroBias).array() +=
        Squared(model_.options.gyro_walk_radps) * duration_s_;
    noise(kWheelScale, kWheelScale) += Squared(kLastingShare * model_.options.slip_noise) *
                                       prediction_.way_in_gauge.norm() / kSlipLength_m;
    return prediction_;
  }

 private:
  void AddNoise(const SensorStep& step, const Eigen::Vector3d& rate,
                const Eigen::Vector3d& direction, const Eigen::Vector3d& lever,
                const Matrix6d& move) {
    const DeadReckoningOptions& options = model_.options;
    const FilterOptions& filter = model_.filter;
    // What is not known of a span is the same all along it: it adds up.
    const double together_s2 = duration_s_ * step.duration_s;
    const bool drives = step.way_m.value_or(1.0) != 0.0;
    const double gyro_noise = drives ? options.gyro_driving_noise_radps : options.gyro_noise_radps;
    const double turn_rad2 = step.turn_rate_radps
                                 ? Squared(gyro_noise) * step.duration_s
                                 : Squared(filter.unknown_turn_radps) * together_s2;
    double along_m2 = Squared(filter.unknown_speed_mps) * together_s2;
    double aside_m2 = Squared(kUnknownAside) * along_m2;
    if (step.way_m) {
      const double ground_m = std::abs(*step.way_m) + kScrub_m * rate.norm() * step.duration_s;
      along_m2 = Squared(options.slip_noise) * kSlipLength_m * ground_m;
      aside_m2 = Squared(options.side_slip_noise) * kSlipLength_m * ground_m;
    }
    Eigen::Matrix<double, 6, 3> by_turn;
    by_turn << -Skew(lever), Eigen::Matrix3d::Identity();
    pose_noise_ = move * pose_noise_ * move.transpose();
    pose_noise_ += turn_rad2 * by_turn * by_turn.transpose();
    pose_noise_.topLeftCorner<3, 3>() += aside_m2 * Eigen::Matrix3d::Identity() +
                                         (along_m2 - aside_m2) * direction * direction.transpose();
  }

  const RoverModel& model_;
  CarriedMotion carried_;
  double duration_s_;
  Travel travel_;
  Eigen::Vector3d lever_in_imu_;
  Matrix6d pose_noise_ = Matrix6d::Zero();
  Prediction prediction_;
};

}  // namespace

Rigid3 Corrected(const Rigid3& pose, const Vector6d& error) {
  return {(ExpRotation(error.tail<3>()) * pose.rotation).normalized(),
          pose.translation + error.head<3>()};
}

Vector6d ErrorBetween(const Rigid3& a, const Rigid3& b) {
  Vector6d error;
  error << a.translation - b.translation, LogRotation(a.rotation * b.rotation.conjugate());
  return error;
}

RoverState Corrected(const RoverState& state, const StateVector& error) {
  RoverState corrected{Corrected(state.gauge_from_left, error.head<6>()),
                       ExpRotation(error.segment<3>(kUp)) * state.up_in_gauge,
                       state.values + error};
  corrected.values.head<6>().setZero();
  corrected.values.segment<3>(kUp).setZero();
  return corrected;
}

StateVector ErrorBetween(const RoverState& a, const RoverState& b) {
  StateVector error = a.values - b.values;
  error.head<6>() = ErrorBetween(a.gauge_from_left, b.gauge_from_left);
  error.segment<3>(kUp) =
      LogRotation(Eigen::Quaterniond::FromTwoVectors(b.up_in_gauge, a.up_in_gauge));
  return error;
}

StateVector PriorSigmas(const DeadReckoningOptions& options) {
  // The first frame is the gauge, whose up nothing has told yet.
  constexpr double kExact = 1e-6, kUnknownUp_rad = 0.2;
  StateVector sigmas = StateVector::Constant(kExact);
  sigmas.segment<3>(kGyroBias).setConstant(options.gyro_bias_sigma_radps);
  sigmas(kGyroScale) = options.gyro_scale_sigma;
  sigmas(kWheelScale) = options.wheel_scale_sigma;
  sigmas.segment<2>(kTravel).setConstant(options.travel_sigma_rad);
  sigmas.segment<3>(kContact).setConstant(options.contact_sigma_m);
  sigmas.segment<3>(kUp).setConstant(kUnknownUp_rad);
  sigmas.segment<2>(kLevel).setConstant(options.level_sigma_rad);
  return sigmas;
}

Prediction Predict(const RoverState& state, const SensorSteps& steps, const CarriedMotion& carried,
                   const RoverModel& model) {
  Mover mover(state, steps, carried, model);
  for (const SensorStep& step : steps) mover.Move(step);
  return mover.Finish();
}

}  // namespace rigmap
