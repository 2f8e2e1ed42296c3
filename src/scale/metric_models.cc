#include "scale/metric_models.h"

#include <algorithm>
#include <limits>
#include <map>

#include "core/statistics.h"

namespace rigmap {
namespace {

// Keypoints of the images whose poses come from this model.
std::map<ImageRef, const std::vector<SparseKeypoint>*> KeypointsOf(const SparseModel& model,
                                                                   const AlignedModel& laid) {
  std::map<ImageRef, const std::vector<SparseKeypoint>*> keypoints;
  for (const SparseImage& image : model.images) {
    if (std::ranges::find(laid.keyframes, image.ref.frame) != laid.keyframes.end()) {
      keypoints.emplace(image.ref, &image.keypoints);
    }
  }
  return keypoints;
}

// Left observations first.
std::vector<PointObservation> ObservationsOf(
    const SparsePoint& point,
    const std::map<ImageRef, const std::vector<SparseKeypoint>*>& keypoints,
    std::span<const int> frames) {
  std::vector<PointObservation> observations;
  for (const TrackElement& element : point.track) {
    const auto image = keypoints.find(element.image);
    if (image == keypoints.end()) continue;
    observations.push_back({frames[element.image.frame], static_cast<int>(element.keypoint),
                            element.image.eye, image->second->at(element.keypoint).pixel});
  }
  std::ranges::stable_partition(
      observations, [](const PointObservation& seen) { return seen.eye == Eye::kLeft; });
  return observations;
}

// The distances of neighbouring frames rest on the same points, so that their mean is hardly known
// better than one of them. One or two do not tell how far they spread.
std::optional<double> ScaleSigma(const AlignedKeyframes& aligned) {
  std::optional<double> worst;
  constexpr std::size_t kFewest = 3;
  for (const AlignedModel& model : aligned.models) {
    const std::size_t pairs = model.scale.pairs_used.size() + model.scale.pairs_rejected.size();
    const double spread =
        pairs < kFewest ? std::numeric_limits<double>::infinity() : model.scale.relative_spread;
    worst = std::max(worst.value_or(0.0), spread);
  }
  return worst;
}

}  // namespace

Adjustment InMetres(const std::vector<SparseModel>& models, const AlignedKeyframes& aligned,
                    std::span<const int> frames, int frame_count, const StereoRig& rig) {
  Adjustment result{.rig = rig};
  result.world_from_left.resize(frame_count);
  result.datum_frames.resize(frame_count);
  std::optional<int> datum;
  for (int i = 0; i < frame_count; ++i) result.datum_frames[i] = i;
  for (std::size_t k = 0; k < aligned.world_from_left.size(); ++k) {
    if (!aligned.world_from_left[k]) continue;
    if (!datum) datum = frames[k];
    result.world_from_left[frames[k]] = aligned.world_from_left[k];
    result.datum_frames[frames[k]] = *datum;
  }
  std::vector<double> errors_px;
  for (const AlignedModel& laid : aligned.models) {
    const SparseModel& model = models[laid.model];
    const auto keypoints = KeypointsOf(model, laid);
    for (const SparsePoint& point : model.points) {
      auto observations = ObservationsOf(point, keypoints, frames);
      if (observations.empty() || observations.front().eye != Eye::kLeft) continue;
      result.points.push_back({laid.world_from_model * point.x_in_model, std::move(observations)});
      errors_px.push_back(point.error_px);
    }
  }
  if (!errors_px.empty()) result.reprojection_px = Median(std::move(errors_px));
  result.scale_sigma = ScaleSigma(aligned);
  return result;
}

}  // namespace rigmap
