#include "tests/support/synthetic_rover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

namespace rigmap {
namespace {

constexpr double kCameraHeight_m = 1.1;
constexpr double kCameraTilt_rad = 18.0 * 3.14159265358979323846 / 180.0;

using Cells = std::set<std::pair<int, int>>;  // ground squares of one metre

// Camera axes (x right, y down, z forward) of a camera looking along +x and down.
Eigen::Quaterniond WorldFromTiltedCamera() {
  const double c = std::cos(kCameraTilt_rad), s = std::sin(kCameraTilt_rad);
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(0.0, -1.0, 0.0);
  axes.col(1) = Eigen::Vector3d(-s, 0.0, -c);
  axes.col(2) = Eigen::Vector3d(c, 0.0, -s);
  return Eigen::Quaterniond(axes);
}

std::vector<Rigid3> Drive(const SyntheticRoverOptions& options) {
  std::vector<Rigid3> poses;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int i = 0; i < options.frames; ++i) {
    const double turn = options.curve_rad_per_m * options.step_m;
    const double heading = i * turn;
    poses.push_back(RoverPose(position.x(), position.y(), heading));
    const double chord = heading + 0.5 * turn;
    position += options.step_m * Eigen::Vector3d(std::cos(chord), std::sin(chord), 0.0);
  }
  return poses;
}

Cells CellsWithin(double range_m, const std::vector<Rigid3>& poses) {
  Cells cells;
  const int reach = static_cast<int>(std::ceil(range_m));
  for (const auto& pose : poses) {
    const int x = static_cast<int>(std::floor(pose.translation.x()));
    const int y = static_cast<int>(std::floor(pose.translation.y()));
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int dy = -reach; dy <= reach; ++dy) cells.insert({x + dx, y + dy});
    }
  }
  return cells;
}

std::vector<Eigen::Vector3d> Scatter(const SyntheticRoverOptions& options, const Cells& cells,
                                     std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (const auto& [x, y] : cells) {
    for (int i = 0; i < static_cast<int>(std::lround(options.points_per_m2)); ++i) {
      const double px = x + unit(random), py = y + unit(random);
      const double height = options.relief_m * (2.0 * unit(random) - 1.0);
      points.emplace_back(px, py, height - kCameraHeight_m);
    }
  }
  return points;
}

std::vector<Descriptor> DrawDescriptors(std::size_t count, std::mt19937& random) {
  std::uniform_int_distribution<int> byte(0, 255);
  std::vector<Descriptor> descriptors(count);
  for (auto& descriptor : descriptors) {
    for (auto& value : descriptor) value = static_cast<std::uint8_t>(byte(random));
  }
  return descriptors;
}

std::optional<Eigen::Vector2d> See(const Camera& camera, const Eigen::Vector3d& x_in_camera,
                                   const Eigen::Vector2d& noise) {
  // Beyond the field of view the distortion polynomial folds back into the image.
  if (x_in_camera.head<2>().norm() > x_in_camera.z()) return std::nullopt;
  auto pixel = Project(camera, x_in_camera);
  if (!pixel) return std::nullopt;
  *pixel += noise;
  return camera.Contains(*pixel) ? pixel : std::nullopt;
}

// A sum of waves of all lengths, one set per point, blurred as by a lens.
class PointTextures {
 public:
  explicit PointTextures(unsigned seed) : seed_(seed) {}

  // Grey values around the rounded `found` of a point truly at `pixel` and so far away.
  Patch Show(int point, const Eigen::Vector2d& found, const Eigen::Vector2d& pixel,
             double depth_m) const {
    constexpr int kWaves = 12;
    constexpr double kAmplitude = 20.0, kBlur_px = 0.8;
    std::mt19937 random(seed_ + static_cast<unsigned>(point));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::array<double, kPatchSize * kPatchSize> grey{};
    for (int wave = 0; wave < kWaves; ++wave) {
      const double direction = 2.0 * std::numbers::pi * unit(random);
      const double length_px = 5.0 * std::pow(8.0, unit(random)) * 4.0 / depth_m;
      const double phase = 2.0 * std::numbers::pi * unit(random);
      const double number = 2.0 * std::numbers::pi / length_px;
      const double amplitude = kAmplitude * std::exp(-0.5 * std::pow(number * kBlur_px, 2));
      for (int i = 0; i < kPatchSize * kPatchSize; ++i) {
        const double x = std::round(found.x()) - pixel.x() + i % kPatchSize - kPatchRadius;
        const double y = std::round(found.y()) - pixel.y() + i / kPatchSize - kPatchRadius;
        const double along = x * std::cos(direction) + y * std::sin(direction);
        grey[i] += amplitude * std::sin(number * along + phase);
      }
    }
    Patch patch;
    std::transform(grey.begin(), grey.end(), patch.begin(), [](double value) {
      return static_cast<std::uint8_t>(std::clamp(128.5 + value, 0.0, 255.0));
    });
    return patch;
  }

 private:
  unsigned seed_;
};

class Observer {
 public:
  Observer(const SyntheticRoverOptions& options, SyntheticRover& rover, std::mt19937& random)
      : options_(options),
        rover_(rover),
        random_(random),
        descriptors_(DrawDescriptors(rover.points.size(), random)) {}

  void ObserveFrame(int frame) {
    FrameFeatures seen;
    seen.stamp_ns = options_.first_stamp_ns + frame * options_.frame_interval_ns;
    std::vector<int> point_of_feature;
    std::vector<int> order(rover_.points.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random_);
    const Rigid3 left_from_world = rover_.world_from_left[frame].Inverse();
    for (const int point : order) {
      if (!ObservePoint(left_from_world * rover_.points[point], seen)) continue;
      seen.descriptors.push_back(descriptors_[point]);
      seen.patches.push_back(PatchOf(point, left_from_world * rover_.points[point], seen));
      point_of_feature.push_back(point);
    }
    rover_.frames.push_back(std::move(seen));
    rover_.point_of_feature.push_back(std::move(point_of_feature));
  }

 private:
  bool ObservePoint(const Eigen::Vector3d& x_in_left, FrameFeatures& seen) {
    if (x_in_left.norm() > options_.max_range_m) return false;
    const Eigen::Vector2d left_noise = Noise(), right_noise = Noise();
    const auto left = See(rover_.rig.left.camera, x_in_left, left_noise);
    if (!left) return false;
    const auto right =
        See(rover_.rig.right.camera, rover_.rig.right_from_left * x_in_left, right_noise);
    Feature& feature = seen.features.emplace_back(Feature{.left = *left, .size = 4.0F});
    if (right) feature.right = *right;
    // The rig is nearly parallel: its epipolar lines are rows, to within a few percent of slope.
    if (right) {
      seen.epipolar_errors_px.push_back(static_cast<float>(right_noise.y() - left_noise.y()));
    }
    return true;
  }

  Patch PatchOf(int point, const Eigen::Vector3d& x_in_left, const FrameFeatures& seen) const {
    if (!options_.textured_patches) return Patch{};
    return textures_.Show(point, seen.features.back().left,
                          *Project(rover_.rig.left.camera, x_in_left), x_in_left.z());
  }

  Eigen::Vector2d Noise() {
    const double x = normal_(random_), y = normal_(random_);
    return options_.pixel_sigma * Eigen::Vector2d(x, y);
  }

  const SyntheticRoverOptions& options_;
  SyntheticRover& rover_;
  std::mt19937& random_;
  std::normal_distribution<double> normal_;
  std::vector<Descriptor> descriptors_;
  PointTextures textures_{options_.seed};
};

}  // namespace

StereoRig LocCamRig() {
  StereoRig rig;
  // Published principal points count pixels from 1.
  rig.left.camera = {.width = 1024,
                     .height = 768,
                     .fx = 834.2560029536,
                     .fy = 838.9607387334,
                     .cx = 496.7146425240,
                     .cy = 397.7726521929,
                     .k1 = -0.3599452735,
                     .k2 = 0.1692657155};
  rig.right.camera = {.width = 1024,
                      .height = 768,
                      .fx = 837.1285943173,
                      .fy = 840.8162958028,
                      .cx = 480.9380406691,
                      .cy = 390.4599724722,
                      .k1 = -0.3532452555,
                      .k2 = 0.1566129640};
  Eigen::Matrix3d left_from_right;
  left_from_right << 0.9999918889, -0.0032751107, 0.0023443023, 0.0032800552, 0.9999923979,
      -0.0021084281, -0.0023373792, 0.0021161004, 0.9999950294;
  rig.right_from_left.rotation = Eigen::Quaterniond(left_from_right.transpose()).normalized();
  rig.right_from_left.translation =
      Eigen::Vector3d(-0.1200787783625, -0.0002625249837, 0.0002682925377);
  rig.source = "synthetic LocCam";
  return rig;
}

std::vector<std::optional<SampledFeature>> SampleFeatures(
    const SyntheticRover& rover, int frame, const std::vector<Eigen::Vector2d>& pixels) {
  constexpr double kReach_px = 12.0;
  const PointTextures textures(rover.seed);
  const Rigid3 left_from_world = rover.world_from_left[frame].Inverse();
  std::vector<std::optional<SampledFeature>> sampled(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    double nearest_px = kReach_px;
    for (const int point : rover.point_of_feature[frame]) {
      const Eigen::Vector3d x = left_from_world * rover.points[point];
      const Eigen::Vector2d pixel = *Project(rover.rig.left.camera, x);
      if ((pixel - pixels[i]).norm() >= nearest_px) continue;
      nearest_px = (pixel - pixels[i]).norm();
      SampledFeature& at = sampled[i].emplace();
      at.feature.left = pixels[i];
      const auto right = Project(rover.rig.right.camera, rover.rig.right_from_left * x);
      if (right) at.feature.right = *right + pixels[i] - pixel;
      at.patch = textures.Show(point, pixels[i], pixel, x.z());
    }
  }
  return sampled;
}

Rigid3 RoverPose(double x_m, double y_m, double heading_rad) {
  const Eigen::AngleAxisd yaw(heading_rad, Eigen::Vector3d::UnitZ());
  return {yaw * WorldFromTiltedCamera(), {x_m, y_m, 0.0}};
}

SyntheticRover MakeSyntheticRover(const SyntheticRoverOptions& options) {
  return MakeSyntheticRover(options, Drive(options));
}

SyntheticRover MakeSyntheticRover(const SyntheticRoverOptions& options,
                                  const std::vector<Rigid3>& world_from_left) {
  std::mt19937 random(options.seed);
  SyntheticRover rover;
  rover.rig = LocCamRig();
  rover.seed = options.seed;
  rover.world_from_left = world_from_left;
  rover.points = Scatter(options, CellsWithin(options.max_range_m, rover.world_from_left), random);
  Observer observer(options, rover, random);
  for (std::size_t i = 0; i < world_from_left.size(); ++i) {
    observer.ObserveFrame(static_cast<int>(i));
  }
  return rover;
}

std::vector<std::pair<int, int>> TrueMatches(const SyntheticRover& rover, int frame_a,
                                             int frame_b) {
  std::vector<int> feature_in_a(rover.points.size(), -1), feature_in_b(rover.points.size(), -1);
  const auto invert = [&](int frame, std::vector<int>& feature_of_point) {
    const auto& point_of_feature = rover.point_of_feature[frame];
    for (std::size_t i = 0; i < point_of_feature.size(); ++i) {
      feature_of_point[point_of_feature[i]] = static_cast<int>(i);
    }
  };
  invert(frame_a, feature_in_a);
  invert(frame_b, feature_in_b);
  std::vector<std::pair<int, int>> matches;
  for (std::size_t point = 0; point < rover.points.size(); ++point) {
    if (feature_in_a[point] >= 0 && feature_in_b[point] >= 0) {
      matches.emplace_back(feature_in_a[point], feature_in_b[point]);
    }
  }
  return matches;
}

}  // namespace rigmap
