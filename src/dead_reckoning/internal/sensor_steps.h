// What wheels and gyro say of the time between two frames, in small steps.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "dead_reckoning/dead_reckoning_options.h"
#include "scene/rig.h"
#include "scene/rover_sensors.h"

namespace rigmap {

struct SensorStep {
  double duration_s = 0.0;
  std::optional<Eigen::Vector3d> turn_rate_radps;  // IMU axes; nothing: not measured
  std::optional<double> way_m;                     // of the contact point, forwards
};

// From the start to the end of a span, without gaps.
using SensorSteps = std::vector<SensorStep>;

// The rig file's, else the option's, in metres.
double WheelRadius(const StereoRig& rig, const DeadReckoningOptions& options);

// How far the rover's contact point (ContactInImu) went, as the wheels tell it, at times between
// the samples. Where the rig states the wheels all of them count, each steered one by the cosine of
// its angle; else the middle axle, which is not steered and so goes as far as the contact point.
class WheelWay {
 public:
  WheelWay(const WheelRecord& wheels, const StereoRig& rig, const DeadReckoningOptions& options);

  // Metres between two times; nothing where samples are missing for longer than max_gap_s.
  std::optional<double> Between(StampNs begin_ns, StampNs end_ns) const;
  // Whether no wheel turns, from the sample before to the one after. False where not known.
  bool StandsStill(StampNs begin_ns, StampNs end_ns) const;

 private:
  std::optional<double> At(StampNs stamp_ns) const;

  std::vector<StampNs> stamps_ns_;
  std::vector<double> way_m_;
  std::vector<bool> moves_;
  StampNs max_gap_ns_ = 0;
};

// The steps of the gyro's samples between two times; of one piece where it has none.
SensorSteps CutSteps(StampNs begin_ns, StampNs end_ns, std::span<const InertialSample> inertial,
                     const WheelWay& way, const DeadReckoningOptions& options);

// The point on the ground that moves straight ahead in a turn.
Eigen::Vector3d ContactInImu(const StereoRig& rig, const DeadReckoningOptions& options);

// The gyro's mean over the samples of a span.
struct MeanRate {
  Eigen::Vector3d radps = Eigen::Vector3d::Zero();
  double duration_s = 0.0;
};
MeanRate MeanRateBetween(StampNs begin_ns, StampNs end_ns,
                         std::span<const InertialSample> inertial);

// The first time between two at which samples begin to be missing for longer than max_gap_s, and
// for how long.
struct Gap {
  StampNs begin_ns = 0;
  double duration_s = 0.0;
};
std::optional<Gap> FindGap(std::span<const StampNs> stamps_ns, StampNs begin_ns, StampNs end_ns,
                           double max_gap_s);

}  // namespace rigmap
