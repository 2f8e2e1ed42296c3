#include "adjustment/adjust_without_rig.h"

#include <algorithm>
#include <map>
#include <set>

#include "adjustment/internal/bundle.h"
#include "core/statistics.h"

namespace rigmap {
namespace {

// Each image is a frame of its own: frame i is image i of the model, and the right eye stands where
// the left one does.
Bundle BundleWithoutRig(const SparseModel& model, const StereoRig& rig) {
  Bundle bundle{.rig = rig};
  bundle.rig.right_from_left = Rigid3();
  std::map<ImageRef, int> frame_of_image;
  for (const SparseImage& image : model.images) {
    frame_of_image[image.ref] = static_cast<int>(bundle.left_from_world.size());
    bundle.left_from_world.emplace_back(image.camera_from_model);
  }
  for (const SparsePoint& point : model.points) {
    AdjustedPoint& made = bundle.points.emplace_back();
    made.x = point.x_in_model;
    for (const TrackElement& element : point.track) {
      const int frame = frame_of_image.at(element.image);
      const SparseImage& image = model.images[frame];
      made.observations.push_back({frame, static_cast<int>(element.keypoint), image.ref.eye,
                                   image.keypoints[element.keypoint].pixel});
    }
    std::sort(made.observations.begin(), made.observations.end(),
              [](const auto& a, const auto& b) { return a.frame < b.frame; });
  }
  return bundle;
}

// Keyframes of which both images are there and show enough.
std::set<int> SoundKeyframes(const SparseModel& model, const std::vector<int>& counts,
                             int min_observations) {
  std::map<int, int> sound_images;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    if (counts[i] >= min_observations) ++sound_images[model.images[i].ref.frame];
  }
  std::set<int> sound;
  for (const auto& [keyframe, images] : sound_images) {
    if (images == 2) sound.insert(keyframe);
  }
  return sound;
}

SparseModel ModelOf(const SparseModel& model, const Bundle& bundle, const std::set<int>& sound) {
  SparseModel result{.cameras = model.cameras};
  std::vector<std::optional<std::size_t>> new_index(model.images.size());
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    if (!sound.contains(model.images[i].ref.frame)) continue;
    new_index[i] = result.images.size();
    SparseImage image = model.images[i];
    image.camera_from_model = *bundle.left_from_world[i];
    for (SparseKeypoint& keypoint : image.keypoints) keypoint.point_id.reset();
    result.images.push_back(std::move(image));
  }
  for (const AdjustedPoint& adjusted : bundle.points) {
    SparsePoint point{.id = result.points.size() + 1, .x_in_model = adjusted.x};
    for (const PointObservation& o : adjusted.observations) {
      if (!new_index[o.frame]) continue;
      const auto keypoint = static_cast<std::uint32_t>(o.feature);
      SparseImage& image = result.images[*new_index[o.frame]];
      image.keypoints[keypoint].point_id = point.id;
      point.track.push_back({image.ref, keypoint});
    }
    if (!point.track.empty()) result.points.push_back(std::move(point));
  }
  return result;
}

}  // namespace

SparseModel AdjustWithoutRig(const SparseModel& model, const StereoRig& rig, int min_observations,
                             const AdjustmentOptions& options) {
  Bundle bundle = BundleWithoutRig(model, rig);
  // Rough first, since the poses it starts from are not good to a pixel.
  for (const bool last : {false, true}) {
    const std::vector<double> errors = ErrorsPx(bundle);
    if (errors.empty()) break;
    const double noise_px = std::max(options.min_noise_px, Median(errors));
    if (last) DropBeyond(options.outlier_sigmas * noise_px, errors, bundle);
    if (bundle.points.empty()) continue;
    SolveBundle(options.huber_sigmas * noise_px, last ? kFineTolerance : kRoughTolerance, bundle);
  }
  return ModelOf(model, bundle,
                 SoundKeyframes(model, ObservationsPerFrame(bundle), min_observations));
}

}  // namespace rigmap
