#include "dense/seen_depths.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kDisparitySigmaPx = 0.15;  // of textured ground, matched and refined

// The least of 1 and 3 times a power of ten that is not below `value`.
double RoundUp(double value) {
  constexpr double kRounding = 1e-9;
  const double power = std::pow(10.0, std::floor(std::log10(value) + kRounding));
  for (const double digit : {1.0, 3.0}) {
    if (digit * power >= value * (1.0 - kRounding)) return digit * power;
  }
  return 10.0 * power;
}

}  // namespace

SeenDepths DepthsSeen(const StereoRig& rig,
                      const std::vector<std::vector<Eigen::Vector3d>>& points_in_left,
                      const std::vector<float>& near_of_frames_m) {
  constexpr std::size_t kFewest = 100;
  const Camera& camera = rig.left.camera;
  std::vector<double> depths;
  for (const auto& points : points_in_left) {
    for (const Eigen::Vector3d& x : points) {
      if (x.z() > 0.0) depths.push_back(x.z());
    }
  }
  const double overlapping_m = camera.fx * rig.Baseline() / (0.5 * camera.width);
  // Rigs are built for ground whose disparity is a twentieth of the width: 51, 62 and 38 px of
  // LocCam, KITTI's cameras and EuRoC's.
  constexpr double kUsualGround = 10.0;
  const double near_m =
      near_of_frames_m.empty()
          ? kUsualGround * overlapping_m
          : Median(std::vector<double>(near_of_frames_m.begin(), near_of_frames_m.end()));
  if (depths.size() < kFewest) return {overlapping_m, near_m};
  // In steps of a half octave: a little more or less seen does not make all depth maps others.
  const double half_m = 0.5 * Quantile(depths, 0.001);
  const double rounded_m = std::exp2(0.5 * std::floor(2.0 * std::log2(half_m)));
  return {std::max(overlapping_m, rounded_m), near_m};
}

double VoxelFor(const StereoRig& rig, const SeenDepths& seen) {
  const double focal_px = rig.left.camera.MeanFocal();
  const double pixel_m = seen.near_m / focal_px;
  const double sigma_m = seen.near_m * pixel_m / rig.Baseline() * kDisparitySigmaPx;
  return RoundUp(std::max(pixel_m, sigma_m));
}

}  // namespace rigmap
