#include "imaging/disparity_normal.h"

#include <cmath>
#include <optional>
#include <vector>

#include "geometry/plane_fit.h"

namespace rigmap {
namespace {

constexpr int kReach = 4;
constexpr int kStride = 2;
constexpr float kSameSurfacePx = 1.5F;

bool IsInside(const DepthMap& map, int row, int column) {
  return row >= kReach && column >= kReach && row + kReach < map.disparity.rows &&
         column + kReach < map.disparity.cols;
}

// disparity = plane . (dx, dy, 1): x_slope per pixel, y_slope per pixel, value in the middle.
Eigen::Vector3d NormalOf(const DepthMap& map, int row, int column, const Eigen::Vector3d& plane) {
  if (!plane.allFinite()) return Eigen::Vector3d::Zero();
  const Camera& camera = map.camera;
  const double at_principal_point =
      plane.z() + plane.x() * (camera.cx - column) + plane.y() * (camera.cy - row);
  return -Eigen::Vector3d(plane.x() * camera.fx, plane.y() * camera.fy, at_principal_point)
              .normalized();
}

// Where all of the window belongs to one surface, as it mostly does: the normal equations are
// diagonal. Nothing where it does not.
std::optional<Eigen::Vector3d> FullWindowPlane(const DepthMap& map, int row, int column) {
  constexpr int kSide = 2 * kReach / kStride + 1;
  constexpr double kSquares = 2.0 * (2 * 2 + 4 * 4) * kSide;  // sum of dx^2
  static_assert(kReach == 4 && kStride == 2);
  const float middle = map.disparity.at<float>(row, column);
  float sum = 0.0F, x_sum = 0.0F, y_sum = 0.0F;
  bool is_full = true;
  for (int dy = -kReach; dy <= kReach; dy += kStride) {
    const float* line = map.disparity.ptr<float>(row + dy) + column;
    for (int dx = -kReach; dx <= kReach; dx += kStride) {
      const float off = line[dx] - middle;
      is_full &= (line[dx] > 0.0F) & (std::abs(off) <= kSameSurfacePx);
      sum += off;
      x_sum += static_cast<float>(dx) * off;
      y_sum += static_cast<float>(dy) * off;
    }
  }
  if (!is_full) return std::nullopt;
  return Eigen::Vector3d(x_sum / kSquares, y_sum / kSquares,
                         static_cast<double>(middle) + sum / (kSide * kSide));
}

Eigen::Vector3d NormalOfKnown(const DepthMap& map, int row, int column) {
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
  return NormalOf(map, row, column, fit.Solve());
}

}  // namespace

Eigen::Vector3d NormalInRectified(const DepthMap& map, int row, int column) {
  const std::optional<Eigen::Vector3d> plane =
      IsInside(map, row, column) ? FullWindowPlane(map, row, column) : std::nullopt;
  return plane ? NormalOf(map, row, column, *plane) : NormalOfKnown(map, row, column);
}

cv::Mat NormalsInRectified(const DepthMap& map) {
  cv::Mat normals(map.disparity.size(), CV_32FC3, cv::Scalar::all(0.0));
  for (int row = 0; row < normals.rows; ++row) {
    const float* disparity = map.disparity.ptr<float>(row);
    cv::Vec3f* line = normals.ptr<cv::Vec3f>(row);
    for (int column = 0; column < normals.cols; ++column) {
      if (disparity[column] <= 0.0F) continue;
      const Eigen::Vector3f normal = NormalInRectified(map, row, column).cast<float>();
      line[column] = {normal.x(), normal.y(), normal.z()};
    }
  }
  return normals;
}

bool LiesOnPlane(const DepthMap& map, int row, int column) {
  constexpr int kWideReach = 12, kWideStride = 4;
  constexpr double kMostOff = 0.3;     // px, root mean square
  constexpr double kLeastKnown = 0.8;  // of the pixels asked
  PlaneFit fit;
  std::vector<Eigen::Vector3d> known;
  int asked = 0;
  for (int dy = -kWideReach; dy <= kWideReach; dy += kWideStride) {
    for (int dx = -kWideReach; dx <= kWideReach; dx += kWideStride) {
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
