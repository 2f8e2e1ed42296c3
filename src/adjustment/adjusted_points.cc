#include "adjustment/adjusted_points.h"

#include "adjustment/reprojection.h"
#include "geometry/triangulation.h"

namespace rigmap {
namespace {

void AddObservation(const PointObservation& observation, const StereoRig& rig,
                    const Rigid3& left_from_world, AdjustedPoint& point, std::vector<View>& views) {
  const auto normalised = Undistort(rig.Of(observation.eye).camera, observation.pixel);
  if (!normalised) return;
  const bool is_left = observation.eye == Eye::kLeft;
  views.push_back({is_left ? left_from_world : rig.right_from_left * left_from_world, *normalised});
  point.observations.push_back(observation);
}

bool Agrees(const AdjustedPoint& point, const StereoRig& rig,
            const std::vector<std::optional<Rigid3>>& left_from_world, double max_error_px) {
  for (const PointObservation& observation : point.observations) {
    const auto seen = Reproject(rig, observation.eye, rig.right_from_left,
                                *left_from_world[observation.frame], point.x);
    if (!seen || !((seen->pixel - observation.pixel).norm() <= max_error_px)) return false;
  }
  return true;
}

}  // namespace

std::vector<AdjustedPoint> TriangulateTracks(
    const std::vector<Track>& tracks, const Correspondences& correspondences, const StereoRig& rig,
    const std::vector<std::optional<Rigid3>>& left_from_world, double max_error_px,
    double max_depth_m) {
  std::vector<AdjustedPoint> points;
  for (const Track& track : tracks) {
    AdjustedPoint point;
    std::vector<View> views;
    int frames = 0;
    for (const auto& [frame, index] : track) {
      const auto& pose = left_from_world[frame];
      if (!pose) continue;
      ++frames;
      const Feature& feature = correspondences.features[frame][index];
      AddObservation({frame, index, Eye::kLeft, feature.left}, rig, *pose, point, views);
      if (!feature.right) continue;
      AddObservation({frame, index, Eye::kRight, *feature.right}, rig, *pose, point, views);
    }
    if (frames < 2) continue;
    const auto x = Triangulate(views);
    if (!x) continue;
    point.x = *x;
    const double depth_m = (views.front().camera_from_world * point.x).norm();
    if (depth_m > max_depth_m || !Agrees(point, rig, left_from_world, max_error_px)) continue;
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace rigmap
