#include "scale/free_camera_poses.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/statistics.h"
#include "geometry/triangulation.h"
#include "scale/baseline_scale.h"

namespace rigmap {
namespace {

// model_from_camera of a frame's images.
struct Eyes {
  std::optional<Rigid3> left, right;
};

std::map<int, Eyes> EyesOf(const SparseModel& model) {
  std::map<int, Eyes> frames;
  for (const SparseImage& image : model.images) {
    Eyes& eyes = frames[image.ref.frame];
    (image.ref.eye == Eye::kLeft ? eyes.left : eyes.right) = image.camera_from_model.Inverse();
  }
  return frames;
}

double MeanDistance(const std::map<int, Eyes>& frames, const std::vector<int>& pairs) {
  double sum = 0.0;
  for (const int frame : pairs) {
    const Eyes& eyes = frames.at(frame);
    sum += (eyes.right->translation - eyes.left->translation).norm();
  }
  return sum / static_cast<double>(pairs.size());
}

// model_from_left in metres: the model's camera, its centre scaled.
Rigid3 InMetres(const Rigid3& model_from_camera, double metres_per_unit) {
  return {model_from_camera.rotation, metres_per_unit * model_from_camera.translation};
}

// The rig's left camera, from what its two cameras say.
Rigid3 LeftOf(const Eyes& eyes, const StereoRig& rig, double metres_per_unit) {
  if (!eyes.right) return InMetres(*eyes.left, metres_per_unit);
  const Rigid3 by_right = InMetres(*eyes.right, metres_per_unit) * rig.right_from_left;
  if (!eyes.left) return by_right;
  const Rigid3 left = InMetres(*eyes.left, metres_per_unit);
  const Eigen::Vector3d midpoint =
      0.5 * (left.translation + metres_per_unit * eyes.right->translation);
  const Eigen::Quaterniond rotation = left.rotation.slerp(0.5, by_right.rotation);
  const Eigen::Vector3d midpoint_in_left = 0.5 * rig.right_from_left.Inverse().translation;
  return {rotation, midpoint - rotation * midpoint_in_left};
}

// Where one frame sees a point.
struct StereoSighting {
  const Eigen::Vector2d* left = nullptr;
  const Eigen::Vector2d* right = nullptr;
};

std::map<int, StereoSighting> SightingsOf(const SparsePoint& point,
                                          const std::map<ImageRef, const SparseImage*>& images) {
  std::map<int, StereoSighting> frames;
  for (const TrackElement& element : point.track) {
    const auto image = images.find(element.image);
    if (image == images.end()) continue;
    StereoSighting& seen = frames[element.image.frame];
    (element.image.eye == Eye::kLeft ? seen.left : seen.right) =
        &image->second->keypoints.at(element.keypoint).pixel;
  }
  std::erase_if(frames,
                [](const auto& frame) { return !frame.second.left || !frame.second.right; });
  return frames;
}

std::optional<double> RigDepth(const StereoSighting& seen, const StereoRig& rig) {
  const auto left = Undistort(rig.left.camera, *seen.left);
  const auto right = Undistort(rig.right.camera, *seen.right);
  if (!left || !right) return std::nullopt;
  const auto x_in_left = TriangulateStereo(rig.right_from_left, *left, *right);
  return x_in_left ? std::optional(x_in_left->z()) : std::nullopt;
}

}  // namespace

AlignedKeyframes PoseFreeCameras(const std::vector<SparseModel>& models, int frame_count,
                                 const StereoRig& rig, const ScaleOptions& options) {
  AlignedKeyframes aligned;
  aligned.world_from_left.resize(frame_count);
  const ModelScales scales = MeasureBaselines(models, rig.Baseline(), options);
  // Nothing says how a second model lies to the first.
  for (std::size_t m = 0; m < models.size() && aligned.models.empty(); ++m) {
    if (!scales[m]) continue;
    const auto frames = EyesOf(models[m]);
    AlignedModel laid{.model = static_cast<int>(m), .scale = *scales[m]};
    const double metres_per_unit = rig.Baseline() / MeanDistance(frames, scales[m]->pairs_used);
    laid.scale.metres_per_model_unit = metres_per_unit;
    const Rigid3 world_from_metric = LeftOf(frames.begin()->second, rig, metres_per_unit).Inverse();
    laid.world_from_model = {metres_per_unit, world_from_metric.rotation,
                             world_from_metric.translation};
    for (const auto& [frame, eyes] : frames) {
      aligned.world_from_left[frame] = world_from_metric * LeftOf(eyes, rig, metres_per_unit);
      laid.keyframes.push_back(frame);
    }
    aligned.models.push_back(std::move(laid));
  }
  return aligned;
}

double FocalLengthChange(const SparseModel& model, const StereoRig& rig) {
  double change = 0.0;
  for (const auto& [eye, camera] : model.cameras) {
    const Camera& stated = rig.Of(eye).camera;
    for (const double ratio : {camera.fx / stated.fx, camera.fy / stated.fy}) {
      change = std::max(change, std::max(ratio, 1.0 / ratio) - 1.0);
    }
  }
  return change;
}

std::optional<double> DepthChange(const SparseModel& model, double metres_per_model_unit,
                                  const StereoRig& rig) {
  std::map<ImageRef, const SparseImage*> images;
  for (const SparseImage& image : model.images) images.emplace(image.ref, &image);
  std::map<int, std::vector<double>> changes;
  for (const SparsePoint& point : model.points) {
    for (const auto& [frame, seen] : SightingsOf(point, images)) {
      const auto by_rig_m = RigDepth(seen, rig);
      if (!by_rig_m) continue;
      const Rigid3& left_from_model = images.at({frame, Eye::kLeft})->camera_from_model;
      const double by_model_m = metres_per_model_unit * (left_from_model * point.x_in_model).z();
      changes[frame].push_back(by_model_m / *by_rig_m - 1.0);
    }
  }
  std::erase_if(changes,
                [](const auto& frame) { return frame.second.size() < kLeastSharedPoints; });
  if (changes.empty()) return std::nullopt;
  double squares = 0.0;
  for (auto& [frame, of_points] : changes) {
    const double median = Median(std::move(of_points));
    squares += median * median;
  }
  return std::sqrt(squares / static_cast<double>(changes.size()));
}

}  // namespace rigmap
