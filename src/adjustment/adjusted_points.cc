#include "adjustment/internal/adjusted_points.h"

#include <tbb/parallel_for.h>

#include <limits>

#include "adjustment/reprojection.h"
#include "geometry/triangulation.h"

namespace rigmap {
namespace {

std::vector<View> Views(const AdjustedPoint& point, const StereoRig& rig,
                        const std::vector<std::optional<Rigid3>>& left_from_world) {
  std::vector<View> views;
  for (const PointObservation& observation : point.observations) {
    const Rigid3& pose = *left_from_world[observation.frame];
    views.push_back({observation.eye == Eye::kLeft ? pose : rig.right_from_left * pose,
                     *Undistort(rig.Of(observation.eye).camera, observation.pixel)});
  }
  return views;
}

// The observation that lies furthest from the point's image, if further than max_error_px.
std::optional<std::ptrdiff_t> WorstBeyond(double max_error_px, const AdjustedPoint& point,
                                          const StereoRig& rig,
                                          const std::vector<std::optional<Rigid3>>& poses) {
  std::optional<std::ptrdiff_t> worst;
  double worst_px = max_error_px;
  for (std::size_t i = 0; i < point.observations.size(); ++i) {
    const PointObservation& o = point.observations[i];
    const auto at = Reproject(rig, o.eye, *poses[o.frame], point.x);
    const double error_px =
        at ? (at->pixel - o.pixel).norm() : std::numeric_limits<double>::infinity();
    if (error_px <= worst_px) continue;
    worst = static_cast<std::ptrdiff_t>(i);
    worst_px = error_px;
  }
  return worst;
}

// All observations of a track in frames that have a pose, but for pixels without a ray.
AdjustedPoint Observe(const Track& track, const Correspondences& correspondences,
                      const StereoRig& rig,
                      const std::vector<std::optional<Rigid3>>& left_from_world) {
  AdjustedPoint point;
  const auto add = [&](const PointObservation& observation) {
    const Camera& camera = rig.Of(observation.eye).camera;
    if (Undistort(camera, observation.pixel)) point.observations.push_back(observation);
  };
  for (const auto& [frame, index] : track) {
    if (!left_from_world[frame]) continue;
    const Feature& feature = correspondences.features[frame][index];
    add({frame, index, Eye::kLeft, feature.left});
    if (feature.right) add({frame, index, Eye::kRight, *feature.right});
  }
  return point;
}

// Triangulates, dropping the worst observation until all that is left agrees; false if that is not
// to be had.
bool TriangulatePoint(AdjustedPoint& point, const StereoRig& rig,
                      const std::vector<std::optional<Rigid3>>& left_from_world,
                      double max_error_px) {
  while (SpansFrames(point)) {
    const auto x = Triangulate(Views(point, rig, left_from_world));
    if (!x) return false;
    point.x = *x;
    const auto worst = WorstBeyond(max_error_px, point, rig, left_from_world);
    if (!worst) return true;
    point.observations.erase(point.observations.begin() + *worst);
  }
  return false;
}

}  // namespace

bool SpansFrames(const AdjustedPoint& point) {
  return !point.observations.empty() &&
         point.observations.front().frame != point.observations.back().frame;
}

std::vector<AdjustedPoint> TriangulateTracks(
    const std::vector<Track>& tracks, const Correspondences& correspondences, const StereoRig& rig,
    const std::vector<std::optional<Rigid3>>& left_from_world, double max_error_px,
    double max_depth_m) {
  std::vector<std::optional<AdjustedPoint>> found(tracks.size());
  tbb::parallel_for(std::size_t{0}, tracks.size(), [&](std::size_t i) {
    AdjustedPoint point = Observe(tracks[i], correspondences, rig, left_from_world);
    if (!TriangulatePoint(point, rig, left_from_world, max_error_px)) return;
    const Rigid3& first_from_world = *left_from_world[point.observations.front().frame];
    if ((first_from_world * point.x).norm() <= max_depth_m) found[i] = std::move(point);
  });
  std::vector<AdjustedPoint> points;
  for (auto& point : found) {
    if (point) points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace rigmap
