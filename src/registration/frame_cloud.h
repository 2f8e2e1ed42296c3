// The cloud of points that one stereo frame shows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "imaging/depth_map.h"
#include "registration/registration_options.h"
#include "scene/rig.h"

namespace rigmap {

struct CloudPoint {
  Eigen::Vector3f x_in_left = Eigen::Vector3f::Zero();  // metres, left camera axes
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();     // unit, towards the camera
  std::array<std::uint8_t, 3> rgb{};
  float sigma_m = 0.0F;  // one standard deviation of one measurement along its ray
};
using FrameCloud = std::vector<CloudPoint>;

// Limits in metres, nothing left open.
struct CloudLimits {
  double grid_m = 0.0;
  double min_depth_m = 0.0, max_depth_m = 0.0;
  // Heights along the left camera's -y.
  double min_height_m = 0.0, max_height_m = 0.0;
  int denoise_neighbours = 0;
  double denoise_deviations = 0.0;
};

// What the options ask for with this rig, near ground being so far away. Throws UsageError for a
// grid so fine that PCL could not number its boxes.
CloudLimits LimitsFor(const StereoRig& rig, double near_m, const CloudOptions& options);

// Known pixels within the limits, merged on a box grid (pcl::VoxelGrid), then without statistical
// outliers (pcl::StatisticalOutlierRemoval), with normals of the planes through kNormalNeighbours
// points (pcl::NormalEstimation). Left out: pixels of unsure disparity, and where two surfaces may
// have been mixed. Empty where fewer than kLeastCloudPoints are left.
inline constexpr int kNormalNeighbours = 12;
inline constexpr std::size_t kLeastCloudPoints = 50;
FrameCloud CloudOf(const DepthMap& map, const CloudLimits& limits);

}  // namespace rigmap
