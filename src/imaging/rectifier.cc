#include "imaging/rectifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.h"
#include "imaging/mask.h"

namespace rigmap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Bounds of normalised coordinates.
struct Bounds {
  Eigen::Vector2d low{kInfinity, kInfinity};
  Eigen::Vector2d high{-kInfinity, -kInfinity};

  bool Empty() const { return low.x() > high.x(); }
  void Add(const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

// What a pixel has to be moved by before the camera's model holds for it.
Eigen::Vector2d BesideModel(const RigEye& eye, const Eigen::Vector2d& pixel) {
  return eye.lens_field ? eye.lens_field->At(pixel) : Eigen::Vector2d(0.0, 0.0);
}

// The rectified ray of a pixel; nothing where the calibration has no inverse.
std::optional<Eigen::Vector2d> RectifiedRay(const RigEye& eye,
                                            const Eigen::Quaterniond& rectified_from_eye,
                                            const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector2d> normalised =
      Undistort(eye.camera, pixel + BesideModel(eye, pixel));
  if (!normalised || !IsInsideFold(eye.camera, *normalised)) return std::nullopt;
  const Eigen::Vector3d ray = rectified_from_eye * normalised->homogeneous();
  if (ray.z() <= 0.0) return std::nullopt;
  return ray.hnormalized();
}

// Bounds of the rectified rays of all usable pixels. A continuous map takes a region's extremes at
// its border: only the outermost pixel with a ray is looked at, from both ends of each row and
// column.
Bounds UsableBounds(const RigEye& eye, const Eigen::Quaterniond& rectified_from_eye) {
  const cv::Mat mask = StaticMask(eye);
  Bounds bounds;
  const auto add_outermost = [&](cv::Point from, cv::Point step, int length) {
    for (int i = 0; i < length; ++i, from += step) {
      if (mask.at<uchar>(from) == 0) continue;
      const auto ray = RectifiedRay(eye, rectified_from_eye, {from.x, from.y});
      if (!ray) continue;
      bounds.Add(*ray);
      return;
    }
  };
  for (int row = 0; row < mask.rows; ++row) {
    add_outermost({0, row}, {1, 0}, mask.cols);
    add_outermost({mask.cols - 1, row}, {-1, 0}, mask.cols);
  }
  for (int column = 0; column < mask.cols; ++column) {
    add_outermost({column, 0}, {0, 1}, mask.rows);
    add_outermost({column, mask.rows - 1}, {0, -1}, mask.rows);
  }
  return bounds;
}

// Shortens low..high to at most `longest`, both ends in the same proportion about the axis.
void CutTo(double longest, double& low, double& high) {
  const double length = high - low;
  if (length <= longest) return;
  low *= longest / length;
  high *= longest / length;
}

// Principal point and length of a view that holds low..high (px from the principal point). Whole
// pixels away from the left camera's own principal point: a rectified rig is not resampled.
std::pair<double, int> PrincipalAndLength(double own, double low, double high) {
  constexpr double kRounding = 1e-6;  // px
  const double principal = own + std::ceil(-low - own - kRounding);
  return {principal, static_cast<int>(std::ceil(high + principal - kRounding)) + 1};
}

}  // namespace

Rectifier::Rectifier(const StereoRig& rig) : left_eye_(rig.left), right_eye_(rig.right) {
  const RectifiedAxes axes = Rectify(rig.right_from_left);
  left_from_rectified_ = axes.rectified_from_left.conjugate();
  right_from_rectified_ = axes.rectified_from_right.conjugate();
  baseline_m_ = axes.baseline_m;

  Bounds bounds = UsableBounds(rig.left, axes.rectified_from_left);
  if (bounds.Empty()) {
    throw DataError(rig.source + ": expected usable pixels in the left eye, found none");
  }
  const Bounds right = UsableBounds(rig.right, axes.rectified_from_right);
  bounds.low.x() = std::min(bounds.low.x(), right.low.x());

  const Camera& left = rig.left.camera;
  const double focal = std::max(left.fx, left.fy);
  CutTo(kMaxGrowth * left.width / left.fx, bounds.low.x(), bounds.high.x());
  CutTo(kMaxGrowth * left.height / left.fy, bounds.low.y(), bounds.high.y());
  camera_.fx = camera_.fy = focal;
  std::tie(camera_.cx, camera_.width) =
      PrincipalAndLength(left.cx, focal * bounds.low.x(), focal * bounds.high.x());
  std::tie(camera_.cy, camera_.height) =
      PrincipalAndLength(left.cy, focal * bounds.low.y(), focal * bounds.high.y());

  left_ = MakeMaps(rig.left, left_from_rectified_);
  right_ = MakeMaps(rig.right, right_from_rectified_);
}

Rectifier Rectifier::WithRightTurned(const Eigen::Vector3d& turn) const {
  Rectifier turned = *this;
  turned.right_from_rectified_ = ExpRotation(turn) * right_from_rectified_;
  turned.right_ = MakeMaps(right_eye_, turned.right_from_rectified_);
  return turned;
}

std::optional<Eigen::Vector2d> Rectifier::RectifiedLeft(const Eigen::Vector2d& pixel) const {
  const auto ray = RectifiedRay(left_eye_, left_from_rectified_.conjugate(), pixel);
  if (!ray) return std::nullopt;
  const auto rectified = Project(camera_, ray->homogeneous());
  return rectified && camera_.Contains(*rectified) ? rectified : std::nullopt;
}

Rectifier::Maps Rectifier::MakeMaps(const RigEye& eye,
                                    const Eigen::Quaterniond& eye_from_rectified) const {
  constexpr float kOutside = -1e4F;  // further than any interpolation reaches
  Maps maps{cv::Mat(camera_.height, camera_.width, CV_32FC1, kOutside),
            cv::Mat(camera_.height, camera_.width, CV_32FC1, kOutside)};
  const Eigen::Matrix3d rotation = eye_from_rectified.toRotationMatrix();
  const auto ray_of = [&](int column, int row) -> Eigen::Vector3d {
    return rotation * Eigen::Vector3d((column - camera_.cx) / camera_.fx,
                                      (row - camera_.cy) / camera_.fy, 1.0);
  };
  const auto is_inside = [&](const Eigen::Vector3d& ray) {
    return ray.z() > 0.0 && IsInsideFold(eye.camera, ray.hnormalized());
  };
  // What lies within the corners lies no further out, so that they speak for all.
  const int right = camera_.width - 1, low = camera_.height - 1;
  const bool all_inside = is_inside(ray_of(0, 0)) && is_inside(ray_of(right, 0)) &&
                          is_inside(ray_of(0, low)) && is_inside(ray_of(right, low));
  for (int row = 0; row < camera_.height; ++row) {
    for (int column = 0; column < camera_.width; ++column) {
      const Eigen::Vector3d ray = ray_of(column, row);
      if (!all_inside && !is_inside(ray)) continue;
      // A field varies so slowly that where it is taken, there or here, makes no difference.
      Eigen::Vector2d pixel = Distort(eye.camera, ray.hnormalized());
      pixel -= BesideModel(eye, pixel);
      if (!eye.camera.Contains(pixel)) continue;
      maps.x.at<float>(row, column) = static_cast<float>(pixel.x());
      maps.y.at<float>(row, column) = static_cast<float>(pixel.y());
    }
  }
  return maps;
}

namespace {

cv::Mat Resample(const cv::Mat& image, const cv::Mat& x, const cv::Mat& y) {
  cv::Mat view;
  // Replicated, so that the half pixel outside the outermost centres is not darkened; outside the
  // image the maps point so far away that this would repeat the border: cleared below.
  cv::remap(image, view, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  view.setTo(cv::Scalar::all(0), x < -1.0F);
  return view;
}

cv::Mat ResampleMask(const cv::Mat& mask, const cv::Mat& x, const cv::Mat& y) {
  cv::Mat view;
  cv::remap(mask, view, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
  return view == 255;
}

}  // namespace

cv::Mat Rectifier::RectifyLeft(const cv::Mat& image) const {
  return Resample(image, left_.x, left_.y);
}
cv::Mat Rectifier::RectifyRight(const cv::Mat& image) const {
  return Resample(image, right_.x, right_.y);
}
cv::Mat Rectifier::RectifyLeftMask(const cv::Mat& mask) const {
  return ResampleMask(mask, left_.x, left_.y);
}
cv::Mat Rectifier::RectifyRightMask(const cv::Mat& mask) const {
  return ResampleMask(mask, right_.x, right_.y);
}

}  // namespace rigmap
