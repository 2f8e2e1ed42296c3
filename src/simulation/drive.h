// A planned drive: which scene, which way, when each pair is taken, and what goes wrong.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/stamp.h"
#include "simulation/faults.h"
#include "simulation/rover_motion.h"
#include "simulation/scene_options.h"
#include "simulation/sensor_clock.h"
#include "simulation/simulate_part.h"

namespace rigmap {

// What is certain before there is ground to drive on.
struct DrivePlan {
  SceneOptions scene;
  RoverPath path;
  SensorClock clock;
  std::vector<double> frame_times_s;  // of the stamps, to the millisecond
  FaultPlan faults;
};

// One pair of images.
struct DriveFrame {
  int index = 0;  // on the drive, also of frames that are dropped
  double time_s = 0.0;
  StampNs stamp_ns = 0;
  Rigid3 world_from_left;
  double travelled_m = 0.0;
  FrameFault fault;

  bool HasImage(Eye eye) const { return !fault.dropped && (!fault.lone || *fault.lone == eye); }
  bool IsPaired() const { return HasImage(Eye::kLeft) && HasImage(Eye::kRight); }
  bool IsUsable() const { return IsPaired() && !fault.black && !fault.truncated; }
};

// Where the sun stands goes by what is asked for: behind the rover for its own shadow, ahead of the
// second half of a U-turn, which glares by itself. Throws UsageError.
DrivePlan PlanDrive(const SimulationRequest& request);

// All frames of the drive, in order of time.
std::vector<DriveFrame> FramesOf(const DrivePlan& plan, const RoverMotion& motion,
                                 const RoverMount& mount);

// From just before the first frame of a range to just after its last.
std::vector<TimeSpan> TimesOf(const DrivePlan& plan, const std::vector<FrameRange>& ranges);

}  // namespace rigmap
