#include "registration/frame_cloud.h"

#include <pcl/features/normal_3d.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/search/kdtree.h>

#include <cmath>
#include <limits>

#include "registration/internal/pcl_cloud.h"

namespace rigmap {
namespace {

constexpr double kDisparitySigma_px = 0.1;  // of ground, as SGM and its refinement leave it

// The least of 1, 2 and 5 times a power of ten that is not below `value`.
double RoundedUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (value <= digit * power) return digit * power;
  }
  return 10.0 * power;
}

bool IsWithin(const Eigen::Vector3d& x_in_left, const CloudLimits& limits) {
  const double height_m = -x_in_left.y();
  return x_in_left.z() >= limits.min_depth_m && x_in_left.z() <= limits.max_depth_m &&
         height_m >= limits.min_height_m && height_m <= limits.max_height_m;
}

PclCloud::Ptr KnownPoints(const DepthMap& map, const CloudLimits& limits) {
  auto cloud = std::make_shared<PclCloud>();
  for (int row = 0; row < map.disparity.rows; ++row) {
    for (int column = 0; column < map.disparity.cols; ++column) {
      const float disparity_px = map.disparity.at<float>(row, column);
      const float sigma_px = map.disparity_sigma.at<float>(row, column);
      if (disparity_px <= 0.0F || sigma_px >= kUnsurePx) continue;
      const Eigen::Vector3d x_in_left =
          map.left_from_rectified * map.PointInRectified(column, row, disparity_px);
      if (!IsWithin(x_in_left, limits)) continue;
      PclPoint point;
      point.getVector3fMap() = x_in_left.cast<float>();
      const cv::Vec3b bgr = map.colour.at<cv::Vec3b>(row, column);
      point.r = bgr[2];
      point.g = bgr[1];
      point.b = bgr[0];
      point.curvature = static_cast<float>(map.DepthSigma(disparity_px, sigma_px));
      cloud->push_back(point);
    }
  }
  return cloud;
}

PclCloud::Ptr WithoutOutliers(const PclCloud::Ptr& cloud, const CloudLimits& limits) {
  pcl::StatisticalOutlierRemoval<PclPoint> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(limits.denoise_neighbours);
  filter.setStddevMulThresh(limits.denoise_deviations);
  auto kept = std::make_shared<PclCloud>();
  filter.filter(*kept);
  return kept;
}

// Towards the camera, which is the origin.
void SetNormals(const PclCloud::Ptr& cloud) {
  pcl::NormalEstimation<PclPoint, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<PclPoint>>());
  estimation.setKSearch(kNormalNeighbours);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].getNormalVector3fMap() = normals[i].getNormalVector3fMap();
  }
}

}  // namespace

CloudLimits LimitsFor(const StereoRig& rig, double near_m, const CloudOptions& options) {
  RequireValid(options);
  constexpr double kNearShare = 1.0 / 40.0;
  constexpr double kNoLimit_m = std::numeric_limits<double>::infinity();
  CloudLimits limits{.grid_m = options.grid_m,
                     .min_depth_m = options.min_depth_m,
                     .max_depth_m = options.max_depth_m,
                     .min_height_m = options.max_below_m > 0.0 ? -options.max_below_m : -kNoLimit_m,
                     .max_height_m = options.max_above_m > 0.0 ? options.max_above_m : kNoLimit_m,
                     .denoise_neighbours = options.denoise_neighbours,
                     .denoise_deviations = options.denoise_deviations};
  if (limits.grid_m == 0.0) limits.grid_m = RoundedUp(kNearShare * near_m);
  // sigma_z = z^2 / (f b) sigma_d.
  const double depth_px = rig.left.camera.MeanFocal() * rig.Baseline();
  if (limits.max_depth_m == 0.0) {
    limits.max_depth_m = std::sqrt(limits.grid_m * depth_px / kDisparitySigma_px);
  }
  // Boxes are numbered by 32 bits, three sides of at most twice the depth in a wide view.
  const double finest_m =
      2.0 * limits.max_depth_m / std::cbrt(double{std::numeric_limits<std::int32_t>::max()});
  RequireOption(limits.grid_m > finest_m, "registration.grid_m",
                "more than a six hundredth of registration.max_depth_m", limits.grid_m);
  return limits;
}

FrameCloud CloudOf(const DepthMap& map, const CloudLimits& limits) {
  PclCloud::Ptr cloud = OnGrid(KnownPoints(map, limits), limits.grid_m);
  if (cloud->size() < kLeastCloudPoints) return {};
  if (limits.denoise_neighbours > 0) cloud = WithoutOutliers(cloud, limits);
  if (cloud->size() < kLeastCloudPoints) return {};
  SetNormals(cloud);
  return FromPcl(*cloud);
}

PclCloud::Ptr OnGrid(const PclCloud::Ptr& cloud, double grid_m) {
  pcl::VoxelGrid<PclPoint> filter;
  filter.setInputCloud(cloud);
  filter.setLeafSize(Eigen::Vector4f::Constant(static_cast<float>(grid_m)));
  auto merged = std::make_shared<PclCloud>();
  filter.filter(*merged);
  return merged;
}

void AppendMoved(const FrameCloud& cloud, const Rigid3& b_from_left, PclCloud& all) {
  for (const CloudPoint& point : cloud) {
    PclPoint moved;
    moved.getVector3fMap() = (b_from_left * point.x_in_left.cast<double>()).cast<float>();
    moved.getNormalVector3fMap() =
        (b_from_left.rotation * point.normal.cast<double>()).cast<float>();
    moved.r = point.rgb[0];
    moved.g = point.rgb[1];
    moved.b = point.rgb[2];
    moved.curvature = point.sigma_m;
    all.push_back(moved);
  }
}

PclCloud::Ptr ToPcl(const FrameCloud& cloud) {
  auto all = std::make_shared<PclCloud>();
  AppendMoved(cloud, Rigid3(), *all);
  return all;
}

FrameCloud FromPcl(const PclCloud& cloud) {
  FrameCloud points;
  for (const PclPoint& point : cloud) {
    if (!point.getNormalVector3fMap().allFinite()) continue;
    points.push_back({point.getVector3fMap(),
                      point.getNormalVector3fMap().normalized(),
                      {point.r, point.g, point.b},
                      point.curvature});
  }
  return points;
}

}  // namespace rigmap
