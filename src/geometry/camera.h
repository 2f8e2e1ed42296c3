// Pinhole cameras with radial and tangential distortion.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace rigmap {

// Pixels in OpenCV's convention: the centre of the first pixel is (0, 0). With zero distortion
// this is PINHOLE, without k3 OPENCV, else FULL_OPENCV, in COLMAP's and in the rig files' terms.
struct Camera {
  int width = 0, height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;            // px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;  // of OpenCV's distortion model

  bool IsPinhole() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0 && k3 == 0.0; }
  double MeanFocal() const { return 0.5 * (fx + fy); }
  // Root mean square distance of the image's pixels from its middle.
  double RmsDistancePx() const { return std::hypot(width, height) / std::sqrt(12.0); }
  // True for a pixel whose centre lies in the image.
  bool Contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 &&
           pixel.y() < height - 0.5;
  }
};

// Normalised image coordinates (x/z, y/z) of the undistorted ray -> pixel.
Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised);

// As Distort, with d(pixel) / d(normalised).
Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalised,
                        Eigen::Matrix2d& jacobian);

// Pixel -> normalised coordinates, by Newton's method, to 1e-10; nothing where the distortion has
// no inverse (far outside the image).
std::optional<Eigen::Vector2d> Undistort(const Camera& camera, const Eigen::Vector2d& pixel);

// True for a ray nearer to the axis than where the radial distortion folds back: beyond it a pixel
// would be seen a second time.
bool IsInsideFold(const Camera& camera, const Eigen::Vector2d& normalised);

// Pixel of a point in camera axes, in the image or not; nothing for one not in front of the camera
// or so far aside that the distortion's polynomial would fold it back towards the image.
std::optional<Eigen::Vector2d> Project(const Camera& camera, const Eigen::Vector3d& x_in_camera);

}  // namespace rigmap
