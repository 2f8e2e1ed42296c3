// A slanted, textured plane as both eyes of a rig would photograph it.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "scene/rig.h"

namespace rigmap {

// Points x with normal . x = offset_m, left camera axes. The texture is random, band-limited to
// waves of about 3 px and longer as seen from 2.5 m, the same for equal seeds; of mean grey 110 and
// a deviation of about 30.
class TexturedPlane {
 public:
  explicit TexturedPlane(int seed);

  // CV_8UC1 of the camera's size.
  cv::Mat Render(const Camera& camera, const Rigid3& left_from_eye) const;

  // Where the ray of a left pixel meets the plane, left camera axes.
  std::optional<Eigen::Vector3d> Hit(const Camera& left, const Eigen::Vector2d& pixel) const;

 private:
  Eigen::Vector3d normal_, across_, down_;
  double offset_m_;
  cv::Mat texture_;  // CV_8UC1, square
};

struct StereoShot {
  cv::Mat left, right;
};
StereoShot Photograph(const TexturedPlane& plane, const StereoRig& rig);

}  // namespace rigmap
