// How a small window of one image maps into another.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace rigmap {

// Maps offsets u from the template's centre into the target: x = position + linear (u + bend q),
// q = (u.x u.x, u.x u.y, u.y u.y).
struct PatchWarp {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // px in the target
  // 1/px; what perspective and lenses add, known beforehand: it is not searched. Left out it would
  // draw windows aside, all of a frame the same way, by some hundredths of a pixel.
  Eigen::Matrix<double, 2, 3> bend = Eigen::Matrix<double, 2, 3>::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& u) const { return position + linear * Bent(u); }
  Eigen::Vector2d Bent(const Eigen::Vector2d& u) const {
    return u + bend * Eigen::Vector3d(u.x() * u.x(), u.x() * u.y(), u.y() * u.y());
  }
};

// A map of offsets (px) into the target (px) to second order, by differences over about the radius
// of the windows that are aligned. Nothing where the map gives no numbers there, or is singular.
std::optional<PatchWarp> WarpOf(
    const std::function<Eigen::Vector2d(const Eigen::Vector2d& offset)>& map);

}  // namespace rigmap
