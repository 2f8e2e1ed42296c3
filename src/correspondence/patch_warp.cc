#include "correspondence/patch_warp.h"

#include <Eigen/LU>

namespace rigmap {

std::optional<PatchWarp> WarpOf(
    const std::function<Eigen::Vector2d(const Eigen::Vector2d& offset)>& map) {
  constexpr double kStep_px = 4.0;
  const Eigen::Vector2d h = kStep_px * Eigen::Vector2d::UnitX(),
                        v = kStep_px * Eigen::Vector2d::UnitY();
  const Eigen::Vector2d centre = map(Eigen::Vector2d::Zero()), right = map(h), left = map(-h),
                        below = map(v), above = map(-v);
  PatchWarp warp{.position = centre};
  warp.linear << (right - left) / (2.0 * kStep_px), (below - above) / (2.0 * kStep_px);
  const double square = kStep_px * kStep_px;
  Eigen::Matrix<double, 2, 3> second;
  second << (right + left - 2.0 * centre) / (2.0 * square),
      (map(h + v) + map(-h - v) - map(h - v) - map(v - h)) / (4.0 * square),
      (below + above - 2.0 * centre) / (2.0 * square);
  warp.bend = warp.linear.inverse() * second;
  if (!warp.position.allFinite() || !warp.linear.allFinite() || !warp.bend.allFinite()) {
    return std::nullopt;
  }
  return warp;
}

}  // namespace rigmap
