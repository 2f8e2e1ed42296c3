#include "simulation/drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "simulation/internal/noise.h"
#include "simulation/rig_errors.h"

namespace rigmap {
namespace {

constexpr double kTrigger_s = 0.04;  // by which a pair may be early or late
// When Katwijk's third traverse began, and about how long its parts are.
constexpr StampNs kStart_ns = 1'448'551'418'849'000'000, kPartLength_ns = 145'743'000'000;

double StartHeading(const SimulationRequest& request, const SceneOptions& scene) {
  // A U-turn ends in the opposite direction: there the sun is to stand.
  if (request.path == "u-turn") return scene.sun_azimuth_rad + std::numbers::pi;
  return 0.5 * std::numbers::pi + HashSequence(request.seed, 71).Between(-0.15, 0.15);
}

bool HasShadow(const FaultPlan& faults) {
  return std::ranges::any_of(faults.frames, &FrameFault::shadow);
}

std::vector<double> FrameTimes(const SimulationRequest& request) {
  HashSequence random(request.seed, 72);
  std::vector<double> times_s(request.pairs);
  for (int i = 0; i < request.pairs; ++i) {
    const bool is_end = i == 0 || i == request.pairs - 1;
    const double jitter_s = is_end ? 0.0 : random.Between(-kTrigger_s, kTrigger_s);
    times_s[i] = std::round(1e3 * (i * request.interval_s + jitter_s)) * 1e-3;
  }
  return times_s;
}

// Share of the image that glares when the camera looks so far past the sun.
double GlareFromSun(double heading_rad, double sun_azimuth_rad) {
  constexpr double kMost = 0.25, kWidest_rad = 0.9, kNarrowest_rad = 0.35;
  const double past_rad =
      std::abs(std::remainder(heading_rad - sun_azimuth_rad, 2.0 * std::numbers::pi));
  const double t = std::clamp((kWidest_rad - past_rad) / (kWidest_rad - kNarrowest_rad), 0.0, 1.0);
  return kMost * t * t * (3.0 - 2.0 * t);
}

}  // namespace

void SimulationRequest::Validate() const {
  const auto require = [](bool holds, const char* name, const char* expected, double found) {
    if (!holds) throw UsageError(fmt::format("{}: expected {}, found {}", name, expected, found));
  };
  require(pairs >= 3 && pairs <= 20000, "pairs", "3 to 20000", pairs);
  require(spacing_m > 0.0 && spacing_m <= 5.0, "spacing", "metres in (0, 5]", spacing_m);
  require(interval_s >= 0.1 && interval_s <= 60.0, "interval", "seconds in [0.1, 60]", interval_s);
  require(contrast > 0.0 && contrast <= 4.0, "contrast", "a factor in (0, 4]", contrast);
  require(std::abs(clock_offset_s) <= 60.0, "clock offset", "at most 60 seconds", clock_offset_s);
  require(traverse >= 1 && traverse <= 3, "traverse", "1, 2 or 3", traverse);
  require(part >= 1 && part <= 99, "part", "1 to 99", part);
  require(depth_every >= 1, "depth-every", "at least 1", depth_every);
  require(markers >= 0 && markers <= 500, "markers", "0 to 500", markers);
  require(sand_cell_m >= 0.005 && sand_cell_m <= 0.1, "sand cell", "metres in [0.005, 0.1]",
          sand_cell_m);
  WithRigErrors(rig, rig_errors);
}

DrivePlan PlanDrive(const SimulationRequest& request) {
  request.Validate();
  SceneOptions scene = MakeScene(request.scene, request.seed);
  scene.contrast *= request.contrast;
  scene.markers = request.markers;
  scene.sand_cell_m = request.sand_cell_m;
  const double heading_rad = StartHeading(request, scene);
  RoverPath path = MakeRoverPath({.shape = request.path,
                                  .intervals = request.pairs - 1,
                                  .spacing_m = request.spacing_m,
                                  .interval_s = request.interval_s,
                                  .start_heading_rad = heading_rad});
  FaultPlan faults = PlanFaults(request.faults, request.pairs, request.seed, request.interval_s);
  if (HasShadow(faults)) scene.sun_azimuth_rad = heading_rad + std::numbers::pi + 0.22;
  const SensorClock clock{kStart_ns + (request.part - 1) * kPartLength_ns, request.seed};
  return {scene, std::move(path), clock, FrameTimes(request), std::move(faults)};
}

std::vector<DriveFrame> FramesOf(const DrivePlan& plan, const RoverMotion& motion,
                                 const RoverMount& mount) {
  const bool turns_to_sun =
      std::abs(std::remainder(
          plan.path.At(0.0).heading_rad - plan.scene.sun_azimuth_rad - std::numbers::pi,
          2.0 * std::numbers::pi)) < 1e-6;
  std::vector<DriveFrame> frames;
  for (int i = 0; i < static_cast<int>(plan.frame_times_s.size()); ++i) {
    const double time_s = plan.frame_times_s[i];
    const PlanarState state = plan.path.At(time_s);
    DriveFrame frame{.index = i,
                     .time_s = time_s,
                     .stamp_ns = plan.clock.StampAt(time_s),
                     .world_from_left = motion.WorldFromBody(time_s) * mount.body_from_left,
                     .travelled_m = state.travelled_m,
                     .fault = plan.faults.frames[i]};
    if (turns_to_sun) {
      frame.fault.glare_area = std::max(
          frame.fault.glare_area, GlareFromSun(state.heading_rad, plan.scene.sun_azimuth_rad));
    }
    frames.push_back(frame);
  }
  return frames;
}

std::vector<TimeSpan> TimesOf(const DrivePlan& plan, const std::vector<FrameRange>& ranges) {
  constexpr double kMargin_s = 0.1;
  std::vector<TimeSpan> spans;
  for (const auto& [first, end] : ranges) {
    spans.push_back(
        {plan.frame_times_s[first] - kMargin_s, plan.frame_times_s[end - 1] + kMargin_s});
  }
  return spans;
}

}  // namespace rigmap
