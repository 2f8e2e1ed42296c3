#include "tests/colmap/rover_database.h"

#include <algorithm>

namespace rigmap {
namespace {

std::string ImageName(const SyntheticRover& rover, int frame, Eye eye) {
  return (eye == Eye::kLeft ? "left/" : "right/") + std::to_string(rover.frames[frame].stamp_ns) +
         ".png";
}

std::vector<SparseCamera> RoverCameras(const SyntheticRover& rover) {
  return {{Eye::kLeft, rover.rig.left.camera}, {Eye::kRight, rover.rig.right.camera}};
}

void Swap(DatabasePair& pair) {
  std::swap(pair.image_a, pair.image_b);
  for (auto& [a, b] : pair.matches) std::swap(a, b);
}

void AddFrame(const SyntheticRover& rover, int frame, DatabaseContent& content) {
  DatabaseImage left{{frame, Eye::kLeft}, ImageName(rover, frame, Eye::kLeft), {}};
  DatabaseImage right{{frame, Eye::kRight}, ImageName(rover, frame, Eye::kRight), {}};
  DatabasePair stereo{left.ref, right.ref, {}};
  for (const auto& feature : rover.frames[frame].features) {
    if (feature.right) {
      stereo.matches.emplace_back(left.keypoints.size(), right.keypoints.size());
      right.keypoints.push_back(feature.right->cast<float>());
    }
    left.keypoints.push_back(feature.left.cast<float>());
  }
  content.images.push_back(std::move(left));
  content.images.push_back(std::move(right));
  content.pairs.push_back(std::move(stereo));
}

}  // namespace

DatabaseContent RoverDatabase(const SyntheticRover& rover, int neighbours) {
  DatabaseContent content{.cameras = RoverCameras(rover), .images = {}, .pairs = {}};
  const int frames = static_cast<int>(rover.frames.size());
  for (int i = 0; i < frames; ++i) AddFrame(rover, i, content);
  for (int i = 0; i < frames; ++i) {
    for (int j = i + 1; j <= std::min(i + neighbours, frames - 1); ++j) {
      DatabasePair pair{{i, Eye::kLeft}, {j, Eye::kLeft}, {}};
      for (const auto& [a, b] : TrueMatches(rover, i, j)) pair.matches.emplace_back(a, b);
      content.pairs.push_back(std::move(pair));
    }
  }
  for (std::size_t i = 1; i < content.pairs.size(); i += 2) Swap(content.pairs[i]);
  return content;
}

SparseModel RoverPoses(const SyntheticRover& rover, int frames) {
  SparseModel model;
  model.cameras = RoverCameras(rover);
  for (int i = 0; i < frames; ++i) {
    const Rigid3 left_from_world = rover.world_from_left[i].Inverse();
    for (const Eye eye : kEyes) {
      SparseImage image;
      image.ref = {i, eye};
      image.name = ImageName(rover, i, eye);
      image.camera_from_model =
          eye == Eye::kLeft ? left_from_world : rover.rig.right_from_left * left_from_world;
      model.images.push_back(std::move(image));
    }
  }
  return model;
}

}  // namespace rigmap
