#include "gates/temporal_depth.h"

#include <cmath>
#include <optional>
#include <utility>

namespace rigmap {
namespace {

// A point as the left image of a frame shows it.
struct LeftView {
  int frame = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;                   // z = 1
  std::optional<Eigen::Vector2d> right;  // its stereo match
};

std::vector<LeftView> LeftViews(const AdjustedPoint& point, const Camera& left) {
  std::vector<LeftView> views;
  for (const PointObservation& observation : point.observations) {
    if (observation.eye == Eye::kLeft) {
      const auto normalised = Undistort(left, observation.pixel);
      if (!normalised) continue;
      views.push_back({observation.frame, observation.pixel, normalised->homogeneous(), {}});
    } else if (!views.empty() && views.back().frame == observation.frame) {
      views.back().right = observation.pixel;
    }
  }
  return views;
}

// Where a camera sees the point at an inverse depth along a ray of another, and how fast it moves.
struct PointOnRay {
  Eigen::Vector2d pixel;
  Eigen::Vector2d slope;  // px per 1/m
};

std::optional<PointOnRay> SeeOnRay(const Camera& camera, const Rigid3& camera_from_ray,
                                   const Eigen::Vector3d& ray, double inverse_depth) {
  constexpr double kMinDepth = 1e-6;  // of the ray's length
  const Eigen::Vector3d& t = camera_from_ray.translation;
  const Eigen::Vector3d x = camera_from_ray.rotation * ray + inverse_depth * t;
  if (!(x.z() > kMinDepth)) return std::nullopt;
  const Eigen::Vector2d normalised = x.hnormalized();
  Eigen::Matrix2d jacobian;
  const Eigen::Vector2d pixel = Distort(camera, normalised, jacobian);
  return PointOnRay{pixel, jacobian * (t.head<2>() - normalised * t.z()) / x.z()};
}

// Least squares over the left images of the other frames.
struct TemporalDepth {
  double inverse_depth = 0.0;                           // 1/m
  double information = 0.0;                             // of it, for noise of one pixel
  Eigen::Vector2d slope_sum = Eigen::Vector2d::Zero();  // of all images
};

// The left images of all frames but one that show the point of one of its rays.
class OtherFrames {
 public:
  OtherFrames(const Adjustment& adjustment, const std::vector<LeftView>& views, std::size_t here)
      : left_(adjustment.rig.left.camera), ray_(views[here].ray) {
    const Rigid3& world_from_here = *adjustment.world_from_left[views[here].frame];
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (i == here) continue;
      const Rigid3& world_from_there = *adjustment.world_from_left[views[i].frame];
      sights_.emplace_back(world_from_there.Inverse() * world_from_here, views[i].pixel);
    }
  }

  // By the method of Gauss and Newton from a guess; nothing where it leads behind a camera.
  std::optional<TemporalDepth> DepthFrom(double inverse_depth) const {
    constexpr int kMaxIterations = 10;
    for (int i = 0; i < kMaxIterations; ++i) {
      TemporalDepth depth{.inverse_depth = inverse_depth};
      double gain = 0.0;
      for (const auto& [there_from_here, pixel] : sights_) {
        const auto seen = SeeOnRay(left_, there_from_here, ray_, inverse_depth);
        if (!seen) return std::nullopt;
        depth.information += seen->slope.squaredNorm();
        depth.slope_sum += seen->slope;
        gain += seen->slope.dot(pixel - seen->pixel);
      }
      if (!(depth.information > 0.0)) return std::nullopt;
      const double step = gain / depth.information;
      inverse_depth += step;
      if (!(inverse_depth > 0.0)) return std::nullopt;
      if (std::abs(step) < 1e-6 * inverse_depth) return depth;
    }
    return std::nullopt;
  }

 private:
  const Camera& left_;
  const Eigen::Vector3d ray_;
  std::vector<std::pair<Rigid3, Eigen::Vector2d>> sights_;  // there_from_here, pixel there
};

// Nothing where the other frames know the depth less well than a stereo match would.
std::optional<DepthDifference> Compare(const Adjustment& adjustment,
                                       const std::vector<LeftView>& views, std::size_t here,
                                       const Eigen::Vector3d& x) {
  const LeftView& view = views[here];
  const double depth_m = (adjustment.world_from_left[view.frame]->Inverse() * x).z();
  if (!(depth_m > 0.0)) return std::nullopt;
  const auto temporal = OtherFrames(adjustment, views, here).DepthFrom(1.0 / depth_m);
  if (!temporal) return std::nullopt;
  const StereoRig& rig = adjustment.rig;
  const auto seen =
      SeeOnRay(rig.right.camera, rig.right_from_left, view.ray, temporal->inverse_depth);
  if (!seen) return std::nullopt;
  const double slope = seen->slope.norm();
  const double temporal_variance = slope * slope / temporal->information;
  if (!(temporal_variance <= 1.0)) return std::nullopt;
  const Eigen::Vector2d along = seen->slope / slope;
  // Noise of the left pixel moves the ray, and with it what both estimates should see.
  const Eigen::Vector2d by_left = slope / temporal->information * temporal->slope_sum - along;
  return DepthDifference{.frame = view.frame,
                         .pixel = view.pixel,
                         .disparity_px = slope * temporal->inverse_depth,
                         .difference_px = along.dot(*view.right - seen->pixel),
                         .variance = 1.0 + by_left.squaredNorm() + temporal_variance};
}

}  // namespace

std::vector<DepthDifference> CompareDepths(const Adjustment& adjustment) {
  std::vector<DepthDifference> differences;
  for (std::size_t track = 0; track < adjustment.points.size(); ++track) {
    const AdjustedPoint& point = adjustment.points[track];
    const std::vector<LeftView> views = LeftViews(point, adjustment.rig.left.camera);
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!views[i].right) continue;
      auto difference = Compare(adjustment, views, i, point.x);
      if (!difference) continue;
      difference->track = static_cast<int>(track);
      differences.push_back(*difference);
    }
  }
  return differences;
}

}  // namespace rigmap
