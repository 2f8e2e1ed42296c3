#include "tests/features/rendered_plane.h"

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

constexpr double kCell_m = 0.0025;  // of the texture
constexpr int kCells = 3000;

cv::Mat RandomTexture(int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat sum = cv::Mat::zeros(kCells, kCells, CV_32F);
  // Drawn coarse and enlarged: blurring white noise by that much would take as many seconds.
  for (const int reduction : {3, 12}) {
    cv::Mat noise(kCells / reduction, kCells / reduction, CV_32F), full;
    random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    cv::resize(noise, full, sum.size(), 0.0, 0.0, cv::INTER_CUBIC);
    sum += full;
  }
  cv::Mat texture;
  sum.convertTo(texture, CV_8UC1, 25.0, 110.0);
  cv::GaussianBlur(texture, texture, cv::Size(), 1.0);
  return texture;
}

}  // namespace

TexturedPlane::TexturedPlane(int seed)
    : normal_(Eigen::Vector3d(0.2, -0.45, -0.87).normalized()),
      offset_m_(-2.2),
      texture_(RandomTexture(seed)) {
  across_ = normal_.unitOrthogonal();
  down_ = normal_.cross(across_);
}

cv::Mat TexturedPlane::Render(const Camera& camera, const Rigid3& left_from_eye) const {
  cv::Mat cells(camera.height, camera.width, CV_32FC2, cv::Scalar(-1.0, -1.0));
  const Eigen::Vector3d& eye = left_from_eye.translation;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const auto normalised = Undistort(camera, Eigen::Vector2d(column, row));
      if (!normalised) continue;
      const Eigen::Vector3d ray = left_from_eye.rotation * normalised->homogeneous();
      const Eigen::Vector3d x =
          eye + (offset_m_ - normal_.dot(eye)) / normal_.dot(ray) * ray - offset_m_ * normal_;
      cells.at<cv::Vec2f>(row, column) =
          cv::Vec2f(static_cast<float>(across_.dot(x) / kCell_m + 0.5 * kCells),
                    static_cast<float>(down_.dot(x) / kCell_m + 0.5 * kCells));
    }
  }
  cv::Mat image;
  cv::remap(texture_, image, cells, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return image;
}

std::optional<Eigen::Vector3d> TexturedPlane::Hit(const Camera& left,
                                                  const Eigen::Vector2d& pixel) const {
  const auto normalised = Undistort(left, pixel);
  if (!normalised) return std::nullopt;
  const Eigen::Vector3d ray = normalised->homogeneous();
  return Eigen::Vector3d(offset_m_ / normal_.dot(ray) * ray);
}

StereoShot Photograph(const TexturedPlane& plane, const StereoRig& rig) {
  return {plane.Render(rig.left.camera, Rigid3()),
          plane.Render(rig.right.camera, rig.right_from_left.Inverse())};
}

}  // namespace rigmap
