#include "simulation/simulate_part.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/file.h"
#include "core/progress.h"
#include "dataset/rig_file.h"
#include "georeference/local_frame.h"
#include "simulation/drive.h"
#include "simulation/internal/imu.h"
#include "simulation/internal/rock_files.h"
#include "simulation/internal/rtk.h"
#include "simulation/internal/truth_depth.h"
#include "simulation/internal/truth_files.h"
#include "simulation/internal/truth_surface.h"
#include "simulation/internal/wheel_odometry.h"
#include "simulation/photograph.h"
#include "simulation/rig_errors.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr Geodetic kOrigin{52.2141, 4.4004, 4.08};  // on the beach of Katwijk
constexpr double kOutlineStep_m = 0.25;

using SaturatedShares = std::vector<std::array<double, 2>>;  // of both eyes, per frame

// Images are the work: each by one thread, as many at a time as there are threads.
SaturatedShares WriteImages(const Photographer& photographer, std::span<const DriveFrame> frames,
                            const fs::path& folder) {
  fs::create_directories(folder);
  SaturatedShares saturated(frames.size());
  Progress progress("images", 2 * frames.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, 2 * frames.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          saturated[i / 2][i % 2] = photographer.Write(frames[i / 2], kEyes[i % 2], folder);
          progress.Advance();
        }
      },
      tbb::simple_partitioner());
  return saturated;
}

void WriteSensors(const SimulationRequest& request, const DrivePlan& plan,
                  const RoverMotion& motion, const fs::path& part) {
  const RoverMount mount = MountOf(request.rig);
  const auto fixes = SimulateRtk(motion, mount, LocalFrame(kOrigin), plan.clock,
                                 {request.clock_offset_s, TimesOf(plan, plan.faults.gps_outages)});
  for (const char* name : {"gps-latlong.txt", "gps-utm31.txt"}) {
    WriteFileAtomically(part / name, [&](std::ostream& stream) { WriteRtkRows(stream, fixes); });
  }
  WriteFileAtomically(part / "imu.txt", [&](std::ostream& stream) {
    WriteImuRows(stream, SimulateImu(motion, mount, plan.clock));
  });
  WriteFileAtomically(part / "odometry.txt", [&](std::ostream& stream) {
    WriteOdometryRows(
        stream, SimulateWheelOdometry(motion, plan.clock, TimesOf(plan, plan.faults.slip_bursts)));
  });
}

std::vector<TruthFrame> TruthFrames(std::span<const DriveFrame> frames,
                                    const SaturatedShares& saturated) {
  std::vector<TruthFrame> truth;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const DriveFrame& frame = frames[i];
    if (!frame.IsPaired()) continue;
    truth.push_back({frame.index, frame.stamp_ns, frame.world_from_left, frame.travelled_m,
                     frame.fault.glare_area, saturated[i][0], saturated[i][1]});
  }
  return truth;
}

std::vector<int> UnusableFrames(std::span<const DriveFrame> frames) {
  std::vector<int> unusable;
  for (const auto& frame : frames) {
    if (frame.IsPaired() && !frame.IsUsable()) unusable.push_back(frame.index);
  }
  return unusable;
}

std::vector<Eigen::Vector2d> CameraPath(std::span<const DriveFrame> frames) {
  std::vector<Eigen::Vector2d> positions;
  for (const auto& frame : frames) positions.push_back(frame.world_from_left.translation.head<2>());
  return positions;
}

void WriteTruthOfSurface(const World& world, const SimulationRequest& request,
                         std::span<const DriveFrame> frames, const fs::path& part) {
  std::vector<Rigid3> usable;
  for (const auto& frame : frames) {
    if (frame.IsUsable()) usable.push_back(frame.world_from_left);
  }
  WriteTruthSurface(part / "surface.ply",
                    SurfaceSampler(world, CameraPath(frames), request.surface_reach_m),
                    SurfaceVisibility(world, request.rig, usable));
}

void WriteTruthOfDepth(const World& world, const SimulationRequest& request,
                       std::span<const DriveFrame> frames, const fs::path& folder) {
  const Camera view = TruthDepthCamera(request.rig);
  fs::create_directories(folder);
  WriteTruthDepthCamera(folder, view);
  for (const auto& frame : frames) {
    if (frame.index % request.depth_every != 0) continue;
    WriteTruthDepth(folder, frame.index, RenderTruthDepth(world, view, frame.world_from_left));
  }
}

void WriteMarkers(const World& world, const fs::path& file) {
  nlohmann::json markers = nlohmann::json::array();
  for (const auto& centre : world.markers()) {
    markers.push_back({centre.x(), centre.y(), centre.z()});
  }
  WriteFileAtomically(file, [&](std::ostream& stream) {
    stream << nlohmann::json{{"note", "centres of white discs in a dark ring, level, local ENU"},
                             {"radius_m", World::kMarkerRadius_m},
                             {"centres", markers}}
                  .dump(1)
           << '\n';
  });
}

void WriteRig(const StereoRig& rig, const RoverMount& mount, const fs::path& file) {
  StereoRig complete = rig;
  complete.antenna_in_left = mount.antenna_in_left;
  complete.imu_from_left = mount.imu_from_left;
  WriteFileAtomically(file, [&](std::ostream& stream) { stream << WriteRigFile(complete); });
}

}  // namespace

void WriteRigFiles(const SimulationRequest& request, const fs::path& folder) {
  const RoverMount mount = MountOf(request.rig);
  WriteRig(WithRigErrors(request.rig, request.rig_errors), mount, folder / "data" / "rig.yaml");
  WriteRig(request.rig, mount, folder / "truth" / "rig.yaml");
}

void SimulatePart(const SimulationRequest& request, const fs::path& folder) {
  const DrivePlan plan = PlanDrive(request);
  const World world(plan.scene, plan.path.Outline(kOutlineStep_m));
  const RoverMotion motion(plan.path, [&](double east_m, double north_m) {
    return world.terrain().Height(east_m, north_m);
  });
  const RoverMount mount = MountOf(request.rig);
  const auto frames = FramesOf(plan, motion, mount);
  const LocalFrame local(kOrigin);

  const fs::path data = folder / "data", truth = folder / "truth",
                 name = fmt::format("Part{}", request.part),
                 part = data / fmt::format("Traverse{}", request.traverse) / name;
  const auto saturated =
      WriteImages(Photographer(world, request.rig, plan, motion), frames, part / "LocCam");
  WriteSensors(request, plan, motion, part);
  WriteRigFiles(request, folder);
  WriteRockFiles(data, request.traverse, world.boulders(), local, request.seed);

  const TruthSetting setting{.rig = request.rig,
                             .mount = mount,
                             .scene = plan.scene,
                             .path = request.path,
                             .faults = request.faults,
                             .seed = request.seed,
                             .unusable_frames = UnusableFrames(frames),
                             .gps_clock_offset_s = request.clock_offset_s};
  WriteTruthFiles(truth / name, TruthFrames(frames, saturated), setting, local);
  if (request.true_surface) WriteTruthOfSurface(world, request, frames, truth / name);
  WriteTruthOfDepth(world, request, frames, truth / name / "depth");
  WriteTruthRocks(truth / "rocks.json", world.boulders(), CameraPath(frames), local);
  if (request.markers > 0) WriteMarkers(world, truth / "markers.json");
}

}  // namespace rigmap
