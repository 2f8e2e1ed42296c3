#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "evaluation/height_grid.h"
#include "geometry/plane_fit.h"

namespace rigmap {
namespace {

// 3.5 m across: the largest rocks, 1.1 m wide, fill a tenth of it.
constexpr int kWindowTiles = 5;
constexpr double kWindowSigma_m = 0.8;
constexpr std::size_t kMinCells = 16;  // of a tile's 256; fewer may be stray points
// Of the residuals this share lies below the plane while it is looked for: nearer the ground than
// the rocks where those cover up to half of the window.
constexpr double kShareBelow = 0.3;
constexpr double kMinResidual_m = 0.003;  // about the noise of a cell
constexpr double kGroundBand_m = 0.04;    // relief of sand within a window, off its plane
// m^2; holds a slope near zero where the window, narrower than its root, does not tell it.
constexpr double kSlopeInformation = 0.05;
constexpr int kIterations = 20;

// Mean of the lower half of a tile's cells: a point of the ground even where a rock covers less
// than half of the tile, and on the plane whatever its slope.
std::optional<Eigen::Vector3d> LowerHalf(const TileIndex& tile, const HeightTile& cells) {
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].points == 0) continue;
    const Eigen::Vector2d centre = CentreOf(CellOfTile(tile, i));
    positions.emplace_back(centre.x(), centre.y(), cells[i].mean_m);
  }
  if (positions.size() < kMinCells) return std::nullopt;
  const auto half = static_cast<std::ptrdiff_t>(positions.size() / 2);
  std::nth_element(positions.begin(), positions.begin() + half, positions.end(),
                   [](const auto& a, const auto& b) { return a.z() < b.z(); });
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::for_each(positions.begin(), positions.begin() + half,
                [&](const auto& position) { sum += position; });
  return sum / static_cast<double>(half);
}

struct WindowPoint {
  Eigen::Vector2d arm;  // from the window's centre
  double height_m = 0.0;
  double weight = 0.0;  // by distance
};

Eigen::Vector3d SolvePlane(const std::vector<WindowPoint>& points,
                           const std::vector<double>& weights) {
  PlaneFit fit(Eigen::Vector3d(kSlopeInformation, kSlopeInformation, 1e-12));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& arm = points[i].arm;
    fit.Add(arm.x(), arm.y(), points[i].height_m, weights[i]);
  }
  return fit.Solve();
}

// Quantile regression by reweighting (Koenker and Bassett 1978), then least squares of what lies in
// the ground's band.
Eigen::Vector3d FitGround(const std::vector<WindowPoint>& points) {
  std::vector<double> weights(points.size());
  std::ranges::transform(points, weights.begin(), &WindowPoint::weight);
  Eigen::Vector3d plane = SolvePlane(points, weights);
  const auto reweigh = [&](const auto& weight_of_residual) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double residual_m = points[i].height_m - plane.dot(points[i].arm.homogeneous());
      weights[i] = points[i].weight * weight_of_residual(residual_m);
    }
  };
  for (int i = 0; i < kIterations; ++i) {
    reweigh([](double residual_m) {
      return (residual_m > 0.0 ? kShareBelow : 1.0 - kShareBelow) * kMinResidual_m /
             std::max(std::abs(residual_m), kMinResidual_m);
    });
    // The slope's information is in units of full weights.
    const double most = *std::ranges::max_element(weights);
    for (double& weight : weights) weight /= most;
    plane = SolvePlane(points, weights);
  }
  reweigh([](double residual_m) { return std::abs(residual_m) < kGroundBand_m ? 1.0 : 0.0; });
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  return sum > 0.0 ? SolvePlane(points, weights) : plane;
}

}  // namespace

double GroundLevel::Plane::At(const Eigen::Vector2d& x_in_world) const {
  const Eigen::Vector2d arm = x_in_world - centre;
  return coefficients.dot(arm.homogeneous());
}

GroundLevel::GroundLevel(const HeightGrid& grid) {
  std::map<TileIndex, Eigen::Vector3d> low;
  for (const auto& [tile, cells] : grid.tiles()) {
    if (const auto position = LowerHalf(tile, cells)) low.emplace(tile, *position);
  }
  std::vector<WindowPoint> points;
  for (const auto& [tile, position] : low) {
    Plane plane{.centre = position.head<2>()};
    points.clear();
    for (int dx = -kWindowTiles; dx <= kWindowTiles; ++dx) {
      for (int dy = -kWindowTiles; dy <= kWindowTiles; ++dy) {
        const auto other = low.find({tile.first + dx, tile.second + dy});
        if (other == low.end()) continue;
        const Eigen::Vector2d arm = other->second.head<2>() - plane.centre;
        const double sigmas = arm.norm() / kWindowSigma_m;
        points.push_back({arm, other->second.z(), std::exp(-0.5 * sigmas * sigmas)});
      }
    }
    plane.coefficients = FitGround(points);
    planes_.emplace(tile, plane);
  }
}

std::optional<double> GroundLevel::At(const Eigen::Vector2d& x_in_world) const {
  const auto plane = planes_.find(TileOf(x_in_world));
  if (plane == planes_.end()) return std::nullopt;
  return plane->second.At(x_in_world);
}

std::optional<double> GroundLevel::Near(const Eigen::Vector2d& x_in_world) const {
  if (const auto here = At(x_in_world)) return here;
  const auto nearest = std::ranges::min_element(planes_, {}, [&](const auto& entry) -> double {
    return (entry.second.centre - x_in_world).squaredNorm();
  });
  if (nearest == planes_.end()) return std::nullopt;
  return nearest->second.coefficients.z();  // not carried on along its slope
}

}  // namespace rigmap
