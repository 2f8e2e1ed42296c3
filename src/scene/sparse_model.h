// A sparse reconstruction as COLMAP knows it: cameras, posed images, points with their tracks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/rigid3.h"
#include "geometry/serialize.h"

namespace rigmap {

struct SparseCamera {
  std::uint32_t id = 0;
  Camera camera;  // OpenCV's pixel convention; the files hold COLMAP's

  template <class Archive>
  void serialize(Archive& archive) {
    archive(id, camera);
  }
};

struct SparseKeypoint {
  Eigen::Vector2d pixel;                  // OpenCV's convention
  std::optional<std::uint64_t> point_id;  // the point that it observes

  template <class Archive>
  void serialize(Archive& archive) {
    archive(pixel, point_id);
  }
};

struct SparseImage {
  std::uint32_t id = 0;
  std::uint32_t camera_id = 0;
  std::string name;  // relative to the image folder: "left/<stamp_ns>.png"
  Rigid3 camera_from_model;
  std::vector<SparseKeypoint> keypoints;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(id, camera_id, name, camera_from_model, keypoints);
  }
};

struct TrackElement {
  std::uint32_t image_id = 0;
  std::uint32_t keypoint = 0;  // index into that image's keypoints

  template <class Archive>
  void serialize(Archive& archive) {
    archive(image_id, keypoint);
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
