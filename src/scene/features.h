// Keypoints of a stereo frame. A feature is a keypoint of the left image; where its stereo match in
// the right image was found, it carries that too. Correspondences name features by their index.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/stamp.h"
#include "geometry/serialize.h"

namespace rigmap {

constexpr int kDescriptorSize = 128;
// Holds the window that is aligned (13 x 13) where it has grown by three quarters.
constexpr int kPatchRadius = 14;
constexpr int kPatchSize = 2 * kPatchRadius + 1;

using Descriptor = std::array<std::uint8_t, kDescriptorSize>;
// Grey values around the rounded left keypoint, row by row.
using Patch = std::array<std::uint8_t, std::size_t{kPatchSize} * kPatchSize>;

// 64 bytes, of which a long traverse has millions: without gaps for alignment.
struct Feature {
  using Right = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;
  using RightFromLeft = Eigen::Matrix<float, 2, 2, Eigen::DontAlign>;

  Eigen::Vector2d left = Eigen::Vector2d::Zero();  // px, OpenCV convention, distorted image
  std::optional<Right> right;                      // its stereo match on the epipolar line
  float size = 0.0F;                               // diameter of the keypoint, px
  // How the match moves with the keypoint, as both eyes see the surface around it.
  RightFromLeft right_from_left = RightFromLeft::Identity();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(left, right, size, right_from_left);
  }
};

// Features run in parallel with their descriptors and patches where these were made, and with their
// tracks where they were followed from frame to frame.
struct FrameFeatures {
  StampNs stamp_ns = 0;
  std::vector<Feature> features;
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;
  std::vector<std::int64_t> tracks;  // the same number in all frames that show the same point
  // Signed distances (px, right image) of stereo matches from their epipolar line, as found before
  // any was rejected for it.
  std::vector<float> epipolar_errors_px;
  double usable_share = 1.0;  // of the left image that is not masked
  // Files of this frame that could not be read as images; if there are any, nothing was looked for.
  std::vector<std::string> unreadable_images;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, features, descriptors, patches, tracks, epipolar_errors_px, usable_share,
            unreadable_images);
  }
};

// Gives frame i's features. What is behind it may keep some frames for the next call.
using FeatureSource = std::function<FrameFeatures(int frame)>;

}  // namespace rigmap
