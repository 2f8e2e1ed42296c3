// A sparse reconstruction: cameras, posed images, points with their tracks.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "geometry/serialize.h"
#include "scene/rig.h"

namespace rigmap {

// One eye's image of a frame: of the keyframes where the model was mapped from keyframes, else of
// the part's frames.
struct ImageRef {
  int frame = 0;
  Eye eye = Eye::kLeft;

  // clang-tidy takes the zero that <=> is compared with for a pointer.
  auto operator<=>(const ImageRef&) const = default;  // NOLINT(modernize-use-nullptr)

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frame, eye);
  }
};

struct SparseCamera {
  Eye eye = Eye::kLeft;
  Camera camera;  // OpenCV's pixel convention; COLMAP's files hold its own

  template <class Archive>
  void serialize(Archive& archive) {
    archive(eye, camera);
  }
};

struct SparseKeypoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // OpenCV's convention
  std::optional<std::uint64_t> point_id;            // the point that it observes

  template <class Archive>
  void serialize(Archive& archive) {
    archive(pixel, point_id);
  }
};

struct SparseImage {
  ImageRef ref;
  std::string name;  // relative to the image folder: "left/<stamp_ns>.png"
  Rigid3 camera_from_model;
  std::vector<SparseKeypoint> keypoints;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(ref, name, camera_from_model, keypoints);
  }
};

struct TrackElement {
  ImageRef image;
  std::uint32_t keypoint = 0;  // index into that image's keypoints

  template <class Archive>
  void serialize(Archive& archive) {
    archive(image, keypoint);
  }
};

struct SparsePoint {
  std::uint64_t id = 0;
  Eigen::Vector3d x_in_model = Eigen::Vector3d::Zero();
  std::array<std::uint8_t, 3> rgb{};
  double error_px = -1.0;  // mean reprojection error
  std::vector<TrackElement> track;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(id, x_in_model, rgb, error_px, track);
  }
};

struct SparseModel {
  std::vector<SparseCamera> cameras;
  std::vector<SparseImage> images;
  std::vector<SparsePoint> points;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(cameras, images, points);
  }
};

}  // namespace rigmap
