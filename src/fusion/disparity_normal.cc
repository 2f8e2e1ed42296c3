#include "fusion/internal/disparity_normal.h"

#include <cmath>

#include "geometry/plane_fit.h"

namespace rigmap {

Eigen::Vector3d NormalInRectified(const DepthMap& map, int row, int column) {
  constexpr int kReach = 4;
  constexpr int kStride = 2;
  constexpr float kSameSurfacePx = 1.5F;
  const float middle = map.disparity.at<float>(row, column);
  PlaneFit fit;
  int count = 0;
  for (int dy = -kReach; dy <= kReach; dy += kStride) {
    const int y = row + dy;
    if (y < 0 || y >= map.disparity.rows) continue;
    const float* line = map.disparity.ptr<float>(y);
    for (int dx = -kReach; dx <= kReach; dx += kStride) {
      const int x = column + dx;
      if (x < 0 || x >= map.disparity.cols) continue;
      const float found = line[x];
      if (found <= 0.0F || std::abs(found - middle) > kSameSurfacePx) continue;
      fit.Add(dx, dy, found);
      ++count;
    }
  }
  if (count < kMinNormalPixels) return Eigen::Vector3d::Zero();
  // disparity = plane . (dx, dy, 1): x_slope per pixel, y_slope per pixel, value in the middle.
  const Eigen::Vector3d plane = fit.Solve();
  if (!plane.allFinite()) return Eigen::Vector3d::Zero();
  const Camera& camera = map.camera;
  const double at_principal_point =
      plane.z() + plane.x() * (camera.cx - column) + plane.y() * (camera.cy - row);
  return -Eigen::Vector3d(plane.x() * camera.fx, plane.y() * camera.fy, at_principal_point)
              .normalized();
}

}  // namespace rigmap
