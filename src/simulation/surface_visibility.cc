#include "simulation/internal/surface_visibility.h"

#include <algorithm>
#include <optional>

namespace rigmap {
namespace {

bool IsInImage(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  const std::optional<Eigen::Vector2d> pixel = Project(camera, x_in_camera);
  return pixel && camera.Contains(*pixel);
}

}  // namespace

SurfaceVisibility::SurfaceVisibility(const World& world, const StereoRig& rig,
                                     std::span<const Rigid3> world_from_left)
    : world_(world), left_(rig.left.camera), right_(rig.right.camera) {
  for (const Rigid3& pose : world_from_left) {
    const Rigid3 left_from_world = pose.Inverse();
    views_.push_back({left_from_world, rig.right_from_left * left_from_world, pose.translation});
  }
}

std::vector<bool> SurfaceVisibility::AreVisible(std::span<const SurfaceSample> samples) const {
  std::vector<const View*> views;
  for (const View& view : views_) views.push_back(&view);
  std::vector<bool> visible;
  visible.reserve(samples.size());
  for (const SurfaceSample& sample : samples) visible.push_back(IsVisible(sample, views));
  return visible;
}

// Moves the views that see it to the front.
bool SurfaceVisibility::IsVisible(const SurfaceSample& sample,
                                  std::vector<const View*>& views) const {
  auto seen_by = views.begin();
  for (auto view = views.begin(); view != views.end(); ++view) {
    if (!Sees(**view, sample)) continue;
    std::rotate(seen_by, view, view + 1);
    if (++seen_by == views.begin() + 2) return true;
  }
  return false;
}

bool SurfaceVisibility::Sees(const View& view, const SurfaceSample& sample) const {
  const Eigen::Vector3d to_camera = view.centre_in_world - sample.position;
  const double range2 = to_camera.squaredNorm();
  return range2 >= kMinRange_m * kMinRange_m && range2 <= kMaxRange_m * kMaxRange_m &&
         sample.normal.dot(to_camera) > 0.0 &&
         IsInImage(left_, view.left_from_world * sample.position) &&
         IsInImage(right_, view.right_from_world * sample.position) &&
         !world_.IsOccluded(view.centre_in_world, sample.position);
}

}  // namespace rigmap
