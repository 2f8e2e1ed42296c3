#include "tests/support/rendered_beach.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <stdexcept>

#include "core/stamp.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr double kPi = std::numbers::pi;
constexpr double kCameraHeight_m = 1.1;
constexpr double kCameraTilt_rad = 36.0 * kPi / 180.0;
constexpr StampNs kFirstStamp_ns = 1'500'000'000'250'000'000;
constexpr StampNs kInterval_ns = 500'000'000;

struct Wave {
  Eigen::Vector2d number;  // rad / m
  double phase = 0.0;
};

// The ground's brightness: many waves, so that every place looks like no other.
std::vector<Wave> MakeTexture() {
  constexpr int kWaves = 48;
  constexpr double kShortest_m = 0.03, kLongest_m = 0.6;
  std::mt19937 engine(20);
  const auto unit = [&] { return static_cast<double>(engine()) / 4294967296.0; };
  std::vector<Wave> waves;
  for (int i = 0; i < kWaves; ++i) {
    const double length_m = kShortest_m * std::pow(kLongest_m / kShortest_m, unit());
    const double direction = 2.0 * kPi * unit();
    waves.push_back(
        {2.0 * kPi / length_m * Eigen::Vector2d(std::cos(direction), std::sin(direction)),
         2.0 * kPi * unit()});
  }
  return waves;
}

// What a pixel that spans `span_x` and `span_y` on the ground shows: every wave is weakened by the
// averaging over the pixel, so that nothing aliases.
double Brightness(const std::vector<Wave>& waves, const Eigen::Vector2d& place,
                  const Eigen::Vector2d& span_x, const Eigen::Vector2d& span_y) {
  constexpr double kPixelVariance = 0.2;  // px^2, of a lens a little softer than the pixel
  double sum = 0.0;
  for (const Wave& wave : waves) {
    const double across = wave.number.dot(span_x), along = wave.number.dot(span_y);
    const double exponent = 0.5 * kPixelVariance * (across * across + along * along);
    if (exponent < 8.0) sum += std::exp(-exponent) * std::cos(wave.number.dot(place) + wave.phase);
  }
  return 125.0 + 11.0 * sum;
}

// Where a ray that points below the horizon meets the ground. Steps are so short that they cannot
// pass through it: its slope is below kSteepest.
Eigen::Vector3d MeetGround(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kSteepest = 0.7, kClose_m = 1e-7;
  const double closing = kSteepest * direction.head<2>().norm() - direction.z();
  double along = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d x = origin + along * direction;
    const double above_m = x.z() - GroundHeight(x.x(), x.y());
    if (above_m < kClose_m) return x;
    along += above_m / closing;
  }
  throw std::runtime_error("a ray of the rendered beach does not meet the ground");
}

cv::Mat Render(const Camera& camera, const Rigid3& world_from_camera,
               const std::vector<Wave>& waves) {
  // Where each pixel looks, and those beyond the last column and row.
  const int columns = camera.width + 1;
  std::vector<Eigen::Vector2d> places;
  for (int row = 0; row <= camera.height; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto ray = Undistort(camera, {column, row});
      places.push_back(MeetGround(world_from_camera.translation,
                                  world_from_camera.rotation * ray->homogeneous().normalized())
                           .head<2>());
    }
  }
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const auto* place = &places[row * columns + column];
      const double value =
          Brightness(waves, *place, place[1] - place[0], place[columns] - place[0]);
      image.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  }
  return image;
}

// Camera axes (x right, y down, z forward) of a camera that looks along x and down.
Eigen::Quaterniond WorldFromTiltedCamera(double tilt_rad) {
  const double c = std::cos(tilt_rad), s = std::sin(tilt_rad);
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(0.0, -1.0, 0.0);
  axes.col(1) = Eigen::Vector3d(-s, 0.0, -c);
  axes.col(2) = Eigen::Vector3d(c, 0.0, -s);
  return Eigen::Quaterniond(axes);
}

void WriteImage(const fs::path& path, const cv::Mat& image) {
  fs::create_directories(path.parent_path());
  if (!cv::imwrite(path.string(), image)) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace

StereoRig RenderedRig() {
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
  return rig;
}

double GroundHeight(double x_m, double y_m) {
  return 0.07 * std::sin(3.1 * x_m + 0.4) * std::cos(2.7 * y_m) +
         0.05 * std::sin(4.3 * y_m - 2.2 * x_m + 1.0) + 0.03 * std::cos(5.9 * x_m + 3.3 * y_m);
}

std::vector<Rigid3> RenderedPoses(const RenderedBeachOptions& options) {
  std::vector<Rigid3> poses;
  Eigen::Vector3d position(0.0, 0.0, kCameraHeight_m);
  for (int i = 0; i < options.frames; ++i) {
    const double heading = i * options.step_m * options.turn_rad_per_m;
    const double pitch = 0.02 * std::sin(1.3 * i), roll = 0.02 * std::sin(0.9 * i + 1.0);
    const Eigen::Quaterniond rotation =
        Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) *
        WorldFromTiltedCamera(kCameraTilt_rad + pitch) *
        Eigen::Quaterniond(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
    poses.push_back({rotation, position + Eigen::Vector3d(0.0, 0.0, 0.015 * std::sin(1.1 * i))});
    position += options.step_m * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
  }
  return poses;
}

void WriteRenderedBeach(const fs::path& folder, const RenderedBeachOptions& options) {
  const StereoRig rig = RenderedRig();
  const auto waves = MakeTexture();
  const auto poses = RenderedPoses(options);
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    const std::string name = fmt::format("{:04}.png", i);
    const Rigid3 world_from_right = poses[i] * rig.right_from_left.Inverse();
    WriteImage(folder / "left" / name, Render(rig.left.camera, poses[i], waves));
    WriteImage(folder / "right" / name, Render(rig.right.camera, world_from_right, waves));
  });
  std::ofstream times(folder / "times.txt"), truth(folder / "groundtruth_tum.txt");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string seconds =
        FormatSeconds(kFirstStamp_ns + static_cast<StampNs>(i) * kInterval_ns);
    const auto& [q, t] = poses[i];
    times << seconds << '\n';
    truth << fmt::format("{} {} {} {} {} {} {} {}\n", seconds, t.x(), t.y(), t.z(), q.x(), q.y(),
                         q.z(), q.w());
  }
  std::ofstream(folder / "calib.yaml") << WriteRigFile(rig);
}

}  // namespace rigmap
