// The pair of parallel pinhole views of a stereo rig, for dense matching.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "geometry/rectification.h"
#include "scene/rig.h"

namespace rigmap {

// Both views share one pinhole camera (size, focal length and principal point), so that rows are
// aligned and disparity = column left - column right = fx * baseline_m / z, without any offset.
//
// The views hold every usable pixel (StaticMask) of the left image, and to the left as much more as
// the right image shows: no match is lost. The focal length is the left camera's larger one:
// resolution is nowhere reduced. Where strong distortion would make a view more than kMaxGrowth
// times as wide or high as the image, its outermost rays are cut.
//
// Fields of the lenses are taken out, as distortion is. Immutable once built; thread-safe. Takes 16
// bytes per rectified pixel.
class Rectifier {
 public:
  static constexpr double kMaxGrowth = 1.6;

  // Throws DataError as StaticMask does, and when the left eye has no usable pixel that can be
  // rectified.
  explicit Rectifier(const StereoRig& rig);

  // The same views of a right eye that has turned about its own axes (rad) since: its coordinates
  // are the turn times what the rig says.
  Rectifier WithRightTurned(const Eigen::Vector3d& turn) const;

  // Any image of the eye's size (8 bit, float) -> rectified view, 0 where the eye sees nothing.
  // Bilinear: exact on ramps, no overshoot beside saturated areas; bicubic and Lanczos gave noisier
  // disparities on sand. OpenCV's remap rounds positions to 1/32 px, whatever the type of its maps.
  cv::Mat RectifyLeft(const cv::Mat& image) const;
  cv::Mat RectifyRight(const cv::Mat& image) const;

  // A mask of the eye -> mask of the view: 255 only where all four pixels around were 255.
  cv::Mat RectifyLeftMask(const cv::Mat& mask) const;
  cv::Mat RectifyRightMask(const cv::Mat& mask) const;

  // Where the view shows what a pixel of the left image does; nothing outside the view, and where
  // the calibration has no inverse.
  std::optional<Eigen::Vector2d> RectifiedLeft(const Eigen::Vector2d& pixel) const;

  const Camera& RectifiedCamera() const { return camera_; }
  const Eigen::Quaterniond& LeftFromRectified() const { return left_from_rectified_; }
  double BaselineM() const { return baseline_m_; }

 private:
  struct Maps {
    cv::Mat x, y;  // CV_32FC1: source pixel of each rectified pixel
  };
  Maps MakeMaps(const RigEye& eye, const Eigen::Quaterniond& eye_from_rectified) const;

  RigEye left_eye_, right_eye_;
  Camera camera_;
  Eigen::Quaterniond left_from_rectified_, right_from_rectified_;
  double baseline_m_ = 0.0;
  Maps left_, right_;
};

}  // namespace rigmap
