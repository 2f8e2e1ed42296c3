#include "dead_reckoning/bridge_gaps.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"
#include "dead_reckoning/estimate_motion.h"
#include "dead_reckoning/internal/sensor_steps.h"
#include "dead_reckoning/internal/wheel_agreement.h"
#include "trajectory/lost_frames.h"
#include "trajectory/motion_model.h"

namespace rigmap {
namespace {

// More, and it is the sensors that err: another radius of the wheels, other axes of the IMU.
constexpr double kMostSlips = 0.5;  // of all steps

bool IsPredicted(const OdometryFrame& frame) { return frame.source == PoseSource::kPredicted; }

bool HasSensors(const Dataset& dataset) {
  return dataset.rig.imu_from_left && !dataset.wheels.samples.empty() &&
         !dataset.inertial.samples.empty();
}

// Frames to which images and wheels tell the same way.
std::vector<bool> CheckedByImages(const Odometry& odometry, const EstimatedMotion& motion) {
  std::vector<bool> checked(odometry.size(), false);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    checked[i] = odometry[i].source == PoseSource::kOdometry;
  }
  for (const auto& others : {motion.slips, motion.misled}) {
    for (const int i : others) checked[i] = false;
  }
  return checked;
}

// The motion of a frame's reference in its own axes, as wheels and gyro tell it.
Rigid3 MotionSince(int reference, int frame, const EstimatedMotion& motion) {
  return motion.poses[frame].gauge_from_left.Inverse() * motion.poses[reference].gauge_from_left;
}

// What sensors know of such a motion, as the images bear them out; images gave them their scale.
Matrix6d KnownSince(int reference, int frame, const EstimatedMotion& motion, double scale_sigma) {
  constexpr double kLeast_m = 1e-3, kLeast_rad = 1e-4;
  const SensorAgreement& agreement = motion.agreement;
  const Eigen::Vector3d way = MotionSince(reference, frame, motion).translation;
  const Eigen::Vector3d along = way.stableNormalized();
  const double aside = std::sqrt(agreement.aside);
  Matrix6d times = std::sqrt(agreement.turn) * Matrix6d::Identity();
  times.topLeftCorner<3, 3>() = aside * Eigen::Matrix3d::Identity() +
                                (std::sqrt(agreement.along) - aside) * along * along.transpose();
  Matrix6d covariance = times * motion.poses[frame].since_reference * times;
  covariance.topLeftCorner<3, 3>() += scale_sigma * scale_sigma * way * way.transpose();
  covariance.diagonal().head<3>().array() += kLeast_m * kLeast_m;
  covariance.diagonal().tail<3>().array() += kLeast_rad * kLeast_rad;
  return covariance;
}

// Whether the sensors, with the images about it, tell the length of a visual motion at least twice
// as well as the images alone.
bool IsKnownBetter(const Odometry& odometry, int i, const EstimatedMotion& motion,
                   double scale_sigma) {
  constexpr double kTimes = 2.0;
  const OdometryFrame& frame = odometry[i];
  if (frame.source != PoseSource::kOdometry || frame.reference >= i) return false;
  if (!motion.poses[frame.reference].is_measured || !motion.poses[i].is_measured) return false;
  const Matrix6d known = KnownSince(frame.reference, i, motion, scale_sigma);
  return frame.step_covariance.topLeftCorner<3, 3>().trace() >
         kTimes * kTimes * known.topLeftCorner<3, 3>().trace();
}

// Frames that the sensors are to pose, where they can: lost ones, those of `others`, and those that
// were guessed between one of these and its reference.
std::vector<bool> BySensors(const Odometry& odometry, const std::vector<int>& lost,
                            const std::vector<int>& others, const EstimatedMotion& motion) {
  std::vector<bool> chosen(odometry.size(), false);
  for (const int i : lost) chosen[i] = true;
  for (const int i : others) {
    if (odometry[i].reference >= i) continue;
    chosen[i] = true;
    for (int k = odometry[i].reference + 1; k < i; ++k) {
      if (IsPredicted(odometry[k]) && odometry[k].reference < k) chosen[k] = true;
    }
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!motion.poses[i].is_measured) chosen[i] = false;
  }
  return chosen;
}

// What the sensors are to pose, and on the way there the chance that the wheels slip.
struct Choice {
  std::vector<bool> by_sensors;
  std::vector<double> chance_of_slip;
};

// Certain where the wheels roll unlike each other; where they roll alike, of checked steps the
// share that slipped all the same; where nothing is known of it, the share that slipped.
std::vector<double> ChancesOfSlip(const EstimatedMotion& motion, const WheelAgreement& wheels,
                                  double steps) {
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / steps; };
  std::vector<int> alike_slips;
  std::ranges::set_intersection(motion.slips, wheels.alike, std::back_inserter(alike_slips));
  std::vector<double> chances(motion.poses.size(), share(motion.slips.size()));
  for (const int i : wheels.alike) chances[i] = share(alike_slips.size());
  for (const int i : wheels.unlike) chances[i] = 1.0;
  return chances;
}

// Those lost, those whose visual motion nothing else bears out, and those of which images tell
// little and wheels that roll alike tell more: of wheels that may slip images tell more yet.
Choice Choose(const Dataset& dataset, const Odometry& odometry, const std::vector<int>& lost,
              const EstimatedMotion& motion, double steps, double wheel_radius_m,
              double scale_sigma) {
  std::vector<int> better;
  for (int i = 0; i < static_cast<int>(odometry.size()); ++i) {
    if (IsKnownBetter(odometry, i, motion, scale_sigma)) better.push_back(i);
  }
  std::vector<bool> asked = BySensors(odometry, lost, motion.misled, motion);
  for (const auto& more : {better, motion.slips}) {
    for (const int i : more) asked[i] = true;
  }
  const WheelAgreement wheels =
      AgreementOfWheels(dataset, motion, CheckedByImages(odometry, motion), asked, wheel_radius_m);
  std::vector<int> others = motion.misled;
  std::ranges::set_intersection(better, wheels.alike, std::back_inserter(others));
  return {BySensors(odometry, lost, others, motion), ChancesOfSlip(motion, wheels, steps)};
}

}  // namespace

Odometry BridgeGaps(const Dataset& dataset, Odometry odometry, const DeadReckoningOptions& options,
                    const FilterOptions& filter) {
  const std::vector<int> lost = LostFrames(odometry);
  const std::vector<VisualStep> visual = VisualSteps(odometry);
  if (visual.empty() || (lost.empty() && !HasSensors(dataset))) return odometry;
  std::vector<int> references;
  for (const OdometryFrame& frame : odometry) references.push_back(frame.reference);
  EstimatedMotion motion;
  try {
    motion = EstimateMotion(dataset, visual, options, filter, references);
  } catch (const DataError& error) {
    spdlog::info("wheels and gyro neither check nor bridge the odometry: {}", error.what());
    return odometry;
  }
  const double steps = static_cast<double>(visual.size());
  const double slip_share = static_cast<double>(motion.slips.size()) / steps,
               misled_share = static_cast<double>(motion.misled.size()) / steps;
  if (slip_share > kMostSlips || misled_share > kMostMisled) {
    spdlog::warn(
        "wheels and gyro contradict the images in {} of {} steps: they neither check nor bridge "
        "the "
        "odometry",
        motion.slips.size() + motion.misled.size(), visual.size());
    return odometry;
  }
  spdlog::info("sensors agree with images to {:.2f}, {:.2f}, {:.2f} of their variance",
               motion.agreement.along, motion.agreement.aside, motion.agreement.turn);
  // In order, so that what hangs on a frame follows it.
  const Odometry before = odometry;
  const Choice choice = Choose(dataset, before, lost, motion, steps,
                               WheelRadius(dataset.rig, options), filter.vision_scale_sigma);
  int slipping = 0;
  for (int i = 1; i < static_cast<int>(before.size()); ++i) {
    OdometryFrame& frame = odometry[i];
    if (frame.reference >= i) continue;
    Rigid3 step = OdometricStep(before, frame.reference, i);
    if (choice.by_sensors[i]) {
      const Rigid3 back = MotionSince(frame.reference, i, motion);
      step = back.Inverse();
      frame.step_covariance = KnownSince(frame.reference, i, motion, filter.vision_scale_sigma);
      const Eigen::Vector3d slipped = filter.burst_slip * back.translation;
      frame.step_covariance.topLeftCorner<3, 3>() +=
          choice.chance_of_slip[i] * slipped * slipped.transpose();
      if (choice.chance_of_slip[i] == 1.0) ++slipping;
      frame.source = PoseSource::kOdometry;
      frame.stands_still = false;
      frame.bridged = true;
    }
    frame.world_from_left = odometry[frame.reference].world_from_left * step;
  }
  const auto bridged = std::ranges::count(odometry, true, &OdometryFrame::bridged);
  if (bridged > 0) {
    BridgePredicted(odometry);
    spdlog::warn("{} frames are posed by wheels and gyro: the images lost their way", bridged);
  }
  if (slipping > 0) {
    spdlog::warn("on the way to {} of them the wheels turn unlike each other: they slip", slipping);
  }
  return odometry;
}

}  // namespace rigmap
