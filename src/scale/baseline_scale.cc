#include "scale/baseline_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/statistics.h"

namespace rigmap {
namespace {

std::map<int, Rigid3> LeftPoses(const SparseModel& model) {
  std::map<int, Rigid3> poses;
  for (const SparseImage& image : model.images) {
    const auto& [keyframe, eye] = image.ref;
    if (eye == Eye::kLeft) poses[keyframe] = image.camera_from_model.Inverse();
  }
  return poses;
}

// Distance between the eyes, model units, per keyframe that has both.
std::map<int, double> EyeDistances(const SparseModel& model) {
  const std::map<int, Rigid3> left = LeftPoses(model);
  std::map<int, double> distances;
  for (const SparseImage& image : model.images) {
    const auto& [keyframe, eye] = image.ref;
    const auto other = left.find(keyframe);
    if (eye != Eye::kRight || other == left.end()) continue;
    distances[keyframe] =
        (image.camera_from_model.Inverse().translation - other->second.translation).norm();
  }
  return distances;
}

// What a model is aligned by: a keyframe of its own, and the keyframe nearest to it in time among
// those aligned already (nothing while there is none).
struct Hook {
  int keyframe = 0;
  std::optional<int> aligned;
};

Hook NearestHook(const std::vector<int>& of_model, const std::set<int>& aligned) {
  Hook best{of_model.front(), std::nullopt};
  for (const int keyframe : of_model) {
    for (const int other : aligned) {
      if (!best.aligned || std::abs(other - keyframe) < std::abs(*best.aligned - best.keyframe)) {
        best = {keyframe, other};
      }
    }
  }
  return best;
}

// The similarity of this scale that gives a camera of the model its pose in the world.
Sim3 LayOn(const Rigid3& world_from_left, const Rigid3& model_from_left, double scale) {
  const Sim3 world{scale, world_from_left.rotation, world_from_left.translation};
  const Rigid3 left_from_model = model_from_left.Inverse();
  return world * Sim3{1.0, left_from_model.rotation, left_from_model.translation};
}

}  // namespace

std::optional<BaselineScale> MeasureBaseline(const SparseModel& model, double baseline_m,
                                             const ScaleOptions& options) {
  const std::map<int, double> distances = EyeDistances(model);
  std::vector<double> all, deviations, used;
  for (const auto& [keyframe, distance] : distances) all.push_back(distance);
  if (all.empty()) return std::nullopt;
  const double median = Median(all);
  if (!(median > 0.0)) return std::nullopt;
  for (double distance : all) deviations.push_back(std::abs(distance - median));
  BaselineScale result;
  const double sigma = kSigmaOfMedianDeviation * Median(deviations);
  result.relative_spread = sigma / median;
  const double tolerated =
      std::max(options.max_sigmas * sigma, options.min_tolerated_share * median);
  for (const auto& [keyframe, distance] : distances) {
    const bool good = std::abs(distance - median) <= tolerated;
    (good ? result.pairs_used : result.pairs_rejected).push_back(keyframe);
    if (good) used.push_back(distance);
  }
  result.metres_per_model_unit = baseline_m / Median(used);
  return result;
}

ModelScales MeasureBaselines(const std::vector<SparseModel>& models, double baseline_m,
                             const ScaleOptions& options) {
  ModelScales scales;
  for (const SparseModel& model : models) {
    scales.push_back(MeasureBaseline(model, baseline_m, options));
  }
  return scales;
}

AlignedKeyframes AlignModels(const std::vector<SparseModel>& models, const ModelScales& scales,
                             const std::vector<Rigid3>& odometric) {
  AlignedKeyframes aligned;
  aligned.world_from_left.resize(odometric.size());
  std::set<int> sound;  // aligned keyframes whose baseline agrees
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto& scale = scales[m];
    if (!scale) continue;
    const std::map<int, Rigid3> poses = LeftPoses(models[m]);
    const Hook hook = NearestHook(scale->pairs_used, sound);
    // While no model is aligned, the odometric pose itself is taken.
    const Rigid3 world_from_left =
        hook.aligned ? *aligned.world_from_left[*hook.aligned] *
                           (odometric[*hook.aligned].Inverse() * odometric[hook.keyframe])
                     : odometric[hook.keyframe];
    AlignedModel laid{.model = static_cast<int>(m), .scale = *scale};
    laid.world_from_model =
        LayOn(world_from_left, poses.at(hook.keyframe), scale->metres_per_model_unit);
    for (const auto& [keyframe, model_from_left] : poses) {
      if (aligned.world_from_left[keyframe]) continue;
      aligned.world_from_left[keyframe] = TransformPose(laid.world_from_model, model_from_left);
      laid.keyframes.push_back(keyframe);
    }
    for (const int keyframe : scale->pairs_used) {
      if (std::binary_search(laid.keyframes.begin(), laid.keyframes.end(), keyframe)) {
        sound.insert(keyframe);
      }
    }
    aligned.models.push_back(std::move(laid));
  }
  return aligned;
}

}  // namespace rigmap
