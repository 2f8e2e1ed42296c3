#include "tests/support/simulated_part.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <array>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/error.h"
#include "core/file.h"
#include "core/stamp.h"
#include "dataset/rig_file.h"
#include "simulation/photograph.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr double kSimulatedTilt_rad = 36.0 * std::numbers::pi / 180.0;

// imu_from_left of a camera that looks forward and down. IMU axes: x backward, y right, z up.
Rigid3 ImuFromTiltedCamera(double tilt_rad) {
  const double c = std::cos(tilt_rad), s = std::sin(tilt_rad);
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(0.0, 1.0, 0.0);
  axes.col(1) = Eigen::Vector3d(s, 0.0, -c);
  axes.col(2) = Eigen::Vector3d(-c, 0.0, -s);
  return {Eigen::Quaterniond(axes), {-0.382, -0.078, 0.557}};
}

// More contrast than a real beach has, as the images are small, and a coarser mesh, to be quick.
DrivePlan Plan(const StereoRig& rig, SimulatedWay way) {
  SimulationRequest request;
  request.pairs = way == SimulatedWay::kLoop ? 25 : 8;
  request.spacing_m = 0.3;
  request.seed = way == SimulatedWay::kElsewhere ? 6 : 5;
  request.rig = rig;
  request.contrast = 2.5;
  request.sand_cell_m = 0.03;
  DrivePlan plan = PlanDrive(request);
  const double length_m = plan.path.length_m(), heading_rad = plan.path.At(0.0).heading_rad;
  const double turn_radpm = way == SimulatedWay::kLoop ? 1.0 : 0.1;
  const PathSegment arc{length_m, turn_radpm * length_m,
                        plan.path.duration_s() - RoverPath::kRamp_s};
  plan.path = RoverPath(std::array{arc}, heading_rad);
  return plan;
}

void WriteImage(const fs::path& path, const cv::Mat& image) {
  fs::create_directories(path.parent_path());
  if (!cv::imwrite(path.string(), image)) throw DataError("cannot write " + path.string());
}

void WriteText(const fs::path& path, const std::string& text) {
  WriteFileAtomically(path, [&](std::ostream& stream) { stream << text; });
}

}  // namespace

StereoRig SmallRoverRig() {
  StereoRig rig;
  rig.left.camera = {.width = 320,
                     .height = 240,
                     .fx = 260.0,
                     .fy = 261.0,
                     .cx = 158.4,
                     .cy = 121.3,
                     .k1 = -0.12,
                     .k2 = 0.03};
  rig.right.camera = {.width = 320,
                      .height = 240,
                      .fx = 259.2,
                      .fy = 260.1,
                      .cx = 161.7,
                      .cy = 119.2,
                      .k1 = -0.11,
                      .k2 = 0.025};
  rig.right_from_left = {ExpRotation({0.003, -0.005, 0.002}), {-0.12, 0.0004, -0.0003}};
  rig.antenna_in_left = Eigen::Vector3d(0.03, -0.78, -0.89);
  rig.imu_from_left = ImuFromTiltedCamera(kSimulatedTilt_rad);
  return rig;
}

SimulatedPart::SimulatedPart(SimulatedWay way)
    : rig_(SmallRoverRig()),
      plan_(Plan(rig_, way)),
      world_(plan_.scene, plan_.path.Outline(0.25)),
      motion_(plan_.path,
              [this](double east_m, double north_m) {
                return world_.terrain().Height(east_m, north_m);
              }),
      frames_(FramesOf(plan_, motion_, MountOf(rig_))) {}

double SimulatedPart::HeightAboveGround(const Eigen::Vector3d& position) const {
  constexpr double kAbove_m = 3.0;
  const Eigen::Vector3d from(position.x(), position.y(), kAbove_m);
  return position.z() - world_.Cast(from, -Eigen::Vector3d::UnitZ()).value().position.z();
}

void SimulatedPart::WriteStereoFolder(const fs::path& folder) const {
  const Photographer photographer(world_, rig_, plan_, motion_);
  tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t i) {
    const std::string name = fmt::format("{:04}.png", i);
    WriteImage(folder / "left" / name, photographer.Take(frames_[i], Eye::kLeft));
    WriteImage(folder / "right" / name, photographer.Take(frames_[i], Eye::kRight));
  });
  std::string times, truth;
  for (const DriveFrame& frame : frames_) {
    const std::string seconds = FormatSeconds(frame.stamp_ns);
    const auto& [q, t] = frame.world_from_left;
    times += seconds + '\n';
    truth += fmt::format("{} {} {} {} {} {} {} {}\n", seconds, t.x(), t.y(), t.z(), q.x(), q.y(),
                         q.z(), q.w());
  }
  WriteText(folder / "times.txt", times);
  WriteText(folder / "groundtruth_tum.txt", truth);
  WriteText(folder / "calib.yaml", WriteRigFile(rig_));
}

}  // namespace rigmap
