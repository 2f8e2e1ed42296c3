#include "fusion/internal/disparity_normal.h"

#include <cmath>
#include <vector>

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

bool LiesOnPlane(const DepthMap& map, int row, int column) {
  constexpr int kReach = 12, kStride = 4;
  constexpr double kMostOff = 0.3;     // px, root mean square
  constexpr double kLeastKnown = 0.8;  // of the pixels asked
  PlaneFit fit;
  std::vector<Eigen::Vector3d> known;
  int asked = 0;
  for (int dy = -kReach; dy <= kReach; dy += kStride) {
    for (int dx = -kReach; dx <= kReach; dx += kStride) {
      const int y = row + dy, x = column + dx;
      if (y < 0 || y >= map.disparity.rows || x < 0 || x >= map.disparity.cols) continue;
      ++asked;
      const float found = map.disparity.at<float>(y, x);
      if (found <= 0.0F) continue;
      fit.Add(dx, dy, found);
      known.emplace_back(dx, dy, found);
    }
  }
  const auto count = static_cast<double>(known.size());
  if (count < kMinNormalPixels || count < kLeastKnown * asked) return false;
  const Eigen::Vector3d plane = fit.Solve();
  double sum = 0.0;
  for (const Eigen::Vector3d& at : known) {
    const double off = at.z() - plane.dot(Eigen::Vector3d(at.x(), at.y(), 1.0));
    sum += off * off;
  }
  return sum <= kMostOff * kMostOff * count;  // false for a plane that is not finite
}

}  // namespace rigmap
