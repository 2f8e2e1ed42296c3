#include "adjustment/internal/adjusted_points.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "adjustment/reprojection.h"
#include "geometry/triangulation.h"

namespace rigmap {
namespace {

// The posed frames as tracks are triangulated on them.
class PosedFrames {
 public:
  PosedFrames(const StereoRig& rig, const std::vector<std::optional<Rigid3>>& left_from_world)
      : rig_(rig), left_from_world_(left_from_world) {
    for (const auto& pose : left_from_world) {
      projections_.emplace_back(rig, pose.value_or(Rigid3()));
    }
  }

  bool IsPosed(int frame) const { return left_from_world_[frame].has_value(); }

  // Nothing for a pixel without a ray.
  std::optional<View> ViewOf(const PointObservation& o) const {
    const auto normalised = Undistort(rig_.Of(o.eye).camera, o.pixel);
    if (!normalised) return std::nullopt;
    const Rigid3& pose = *left_from_world_[o.frame];
    return View{o.eye == Eye::kLeft ? pose : rig_.right_from_left * pose, *normalised};
  }

  Eigen::Vector2d Steadied(const RigFlexure& flexure, const PointObservation& o) const {
    return flexure.Steadied(rig_.right.camera, o.frame, o.pixel);
  }

  double ErrorPx(const PointObservation& o, const Eigen::Vector3d& x) const {
    const auto pixel = projections_[o.frame].Project(o.eye, x);
    return pixel ? (*pixel - o.pixel).norm() : std::numeric_limits<double>::infinity();
  }

 private:
  const StereoRig& rig_;
  const std::vector<std::optional<Rigid3>>& left_from_world_;
  std::vector<FrameProjection> projections_;
};

// A point in the making, with the view that belongs to each observation.
struct ViewedPoint {
  AdjustedPoint point;
  std::vector<View> views;
};

// The observation that lies furthest from the point's image, if further than max_error_px.
std::optional<std::ptrdiff_t> WorstBeyond(double max_error_px, const AdjustedPoint& point,
                                          const PosedFrames& frames) {
  std::optional<std::ptrdiff_t> worst;
  double worst_px = max_error_px;
  for (std::size_t i = 0; i < point.observations.size(); ++i) {
    const double error_px = frames.ErrorPx(point.observations[i], point.x);
    if (error_px <= worst_px) continue;
    worst = static_cast<std::ptrdiff_t>(i);
    worst_px = error_px;
  }
  return worst;
}

// All observations of a track in frames that have a pose, but for pixels without a ray.
ViewedPoint Observe(const Track& track, const Correspondences& correspondences,
                    const PosedFrames& frames, const LensField* field, const RigFlexure* flexure) {
  ViewedPoint seen;
  const auto add = [&](PointObservation observation) {
    if (flexure != nullptr && observation.eye == Eye::kRight) {
      observation.pixel = frames.Steadied(*flexure, observation);
    }
    if (field != nullptr) {
      observation.pixel += field->Displacement(observation.eye, observation.pixel);
    }
    const auto view = frames.ViewOf(observation);
    if (!view) return;
    seen.point.observations.push_back(observation);
    seen.views.push_back(*view);
  };
  for (const auto& [frame, index] : track) {
    if (!frames.IsPosed(frame)) continue;
    const Feature& feature = correspondences.features[frame][index];
    add({frame, index, Eye::kLeft, feature.left});
    if (feature.right) add({frame, index, Eye::kRight, *feature.right});
  }
  return seen;
}

// Triangulates, dropping the worst observation until all that is left agrees; false if that is not
// to be had.
bool TriangulatePoint(ViewedPoint& seen, const PosedFrames& frames, double max_error_px) {
  while (SpansFrames(seen.point)) {
    const auto x = Triangulate(seen.views);
    if (!x) return false;
    seen.point.x = *x;
    const auto worst = WorstBeyond(max_error_px, seen.point, frames);
    if (!worst) return true;
    seen.point.observations.erase(seen.point.observations.begin() + *worst);
    seen.views.erase(seen.views.begin() + *worst);
  }
  return false;
}

}  // namespace

bool SpansFrames(const AdjustedPoint& point) {
  return !point.observations.empty() &&
         point.observations.front().frame != point.observations.back().frame;
}

bool IsDetermined(const AdjustedPoint& point, const StereoRig& rig,
                  const std::vector<std::optional<Rigid3>>& left_from_world) {
  constexpr double kLeastBase = 0.01;
  if (!SpansFrames(point)) return false;
  const auto centre_of = [&](const PointObservation& o) {
    const Rigid3& left = *left_from_world[o.frame];
    return (o.eye == Eye::kLeft ? left : rig.right_from_left * left).Inverse().translation;
  };
  const Eigen::Vector3d first = centre_of(point.observations.front());
  return std::ranges::any_of(point.observations, [&](const PointObservation& o) {
    return (centre_of(o) - first).norm() >= kLeastBase * rig.Baseline();
  });
}

std::vector<AdjustedPoint> TriangulateTracks(
    const std::vector<Track>& tracks, const Correspondences& correspondences, const StereoRig& rig,
    const std::vector<std::optional<Rigid3>>& left_from_world, double max_error_px,
    double max_depth_m, const LensField* field, const RigFlexure* flexure) {
  const PosedFrames frames(rig, left_from_world);
  std::vector<std::optional<AdjustedPoint>> found(tracks.size());
  tbb::parallel_for(std::size_t{0}, tracks.size(), [&](std::size_t i) {
    ViewedPoint seen = Observe(tracks[i], correspondences, frames, field, flexure);
    if (!TriangulatePoint(seen, frames, max_error_px)) return;
    AdjustedPoint& point = seen.point;
    if (!IsDetermined(point, rig, left_from_world)) return;
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
