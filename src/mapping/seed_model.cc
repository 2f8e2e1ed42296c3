#include "mapping/seed_model.h"

#include <algorithm>

#include "geometry/triangulation.h"

namespace rigmap {
namespace {

constexpr int kMinSharedTracks = 30;
constexpr double kMaxErrorPx = 4.0;

void AddImages(const GraphWithPoses& input, int keyframe, SparseModel& model) {
  const GraphKeyframe& of = input.graph.keyframes[keyframe];
  const Rigid3 left_from_world = input.world_from_left[keyframe].Inverse();
  SparseImage left{{keyframe, Eye::kLeft}, of.left_name, left_from_world, {}};
  SparseImage right{
      {keyframe, Eye::kRight}, of.right_name, input.rig.right_from_left * left_from_world, {}};
  for (std::size_t i = 0; i < of.features.size(); ++i) {
    const Feature& feature = input.correspondences.features[of.frame][of.features[i]];
    left.keypoints.push_back({feature.left});
    if (of.right_keypoints[i]) right.keypoints.push_back({*feature.right});
  }
  model.images.push_back(std::move(left));
  model.images.push_back(std::move(right));
}

}  // namespace

std::optional<int> BestSeedStart(const KeyframeGraph& graph, const std::vector<bool>& allowed,
                                 int length) {
  if (length < 2) return std::nullopt;
  const int keyframes = static_cast<int>(graph.keyframes.size());
  // shared[k]: tracks that keyframes k and k + 1 both see.
  std::vector<int> shared(keyframes, 0);
  for (const Track& track : graph.tracks) {
    for (std::size_t i = 1; i < track.size(); ++i) {
      if (track[i].frame == track[i - 1].frame + 1) ++shared[track[i - 1].frame];
    }
  }
  std::optional<int> best;
  int best_shared = kMinSharedTracks - 1;
  for (int first = 0; first + length <= keyframes; ++first) {
    int weakest = shared[first];
    bool usable = allowed[first];
    for (int k = first + 1; k < first + length; ++k) {
      usable = usable && allowed[k];
      weakest = std::min(weakest, shared[k - 1]);
    }
    if (usable && weakest > best_shared) {
      best = first;
      best_shared = weakest;
    }
  }
  return best;
}

SparseModel MakeSeedModel(const GraphWithPoses& input, int first, int length) {
  SparseModel model;
  model.cameras = {{Eye::kLeft, input.rig.left.camera}, {Eye::kRight, input.rig.right.camera}};
  for (int k = first; k < first + length; ++k) AddImages(input, k, model);
  const auto index_of = [&](const ImageRef& image) {
    return 2 * static_cast<std::size_t>(image.frame - first) + (image.eye == Eye::kLeft ? 0 : 1);
  };
  for (const Track& track : input.graph.tracks) {
    SparsePoint point;
    std::vector<View> views;
    const auto add = [&](const ImageRef& image, std::uint32_t keypoint) {
      const SparseImage& of = model.images[index_of(image)];
      const Camera& camera = input.rig.Of(of.ref.eye).camera;
      const auto normalised = Undistort(camera, of.keypoints[keypoint].pixel);
      if (!normalised) return;
      views.push_back({of.camera_from_model, *normalised});
      point.track.push_back({of.ref, keypoint});
    };
    for (const auto& [keyframe, keypoint] : track) {
      if (keyframe < first || keyframe >= first + length) continue;
      add({keyframe, Eye::kLeft}, static_cast<std::uint32_t>(keypoint));
      const auto& right = input.graph.keyframes[keyframe].right_keypoints[keypoint];
      if (right) add({keyframe, Eye::kRight}, *right);
    }
    const auto x = views.size() >= 2 ? Triangulate(views) : std::nullopt;
    if (!x) continue;
    const double focal = input.rig.left.camera.MeanFocal();
    const bool agrees = std::all_of(views.begin(), views.end(), [&](const View& view) {
      const Eigen::Vector2d seen = (view.camera_from_world * *x).hnormalized();
      return (seen - view.normalised).norm() * focal <= kMaxErrorPx;
    });
    if (!agrees) continue;
    point.id = model.points.size() + 1;
    point.x_in_model = *x;
    for (const TrackElement& element : point.track) {
      model.images[index_of(element.image)].keypoints[element.keypoint].point_id = point.id;
    }
    model.points.push_back(std::move(point));
  }
  return model;
}

}  // namespace rigmap
