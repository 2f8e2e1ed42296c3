#include "evaluation/internal/point_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

using CubeIndex = std::array<std::int64_t, 3>;

CubeIndex CubeAround(const Eigen::Vector3d& x, double size_m) {
  const auto along = [&](int axis) {
    return static_cast<std::int64_t>(std::floor(x(axis) / size_m));
  };
  return {along(0), along(1), along(2)};
}

PointCells NumberCells(const std::vector<CubeIndex>& index_of_point) {
  std::vector<CubeIndex> distinct = index_of_point;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  PointCells cells;
  cells.sizes.resize(distinct.size(), 0);
  cells.of_point.reserve(index_of_point.size());
  for (const CubeIndex& index : index_of_point) {
    const auto number = std::ranges::lower_bound(distinct, index) - distinct.begin();
    cells.of_point.push_back(static_cast<std::uint32_t>(number));
    ++cells.sizes[static_cast<std::size_t>(number)];
  }
  return cells;
}

}  // namespace

PointCells SortIntoCells(std::span<const Eigen::Vector3d> points, double size_m) {
  std::vector<CubeIndex> index_of_point;
  index_of_point.reserve(points.size());
  for (const auto& x : points) index_of_point.push_back(CubeAround(x, size_m));
  return NumberCells(index_of_point);
}

PointCells SortIntoColumns(std::span<const Eigen::Vector3d> points, double size_m) {
  std::vector<CubeIndex> index_of_point;
  index_of_point.reserve(points.size());
  for (const auto& x : points) index_of_point.push_back(CubeAround({x.x(), x.y(), 0.0}, size_m));
  return NumberCells(index_of_point);
}

std::vector<double> MeansOfCells(const PointCells& cells, std::span<const double> values) {
  std::vector<double> means(cells.sizes.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) means[cells.of_point[i]] += values[i];
  for (std::size_t k = 0; k < means.size(); ++k) means[k] /= static_cast<double>(cells.sizes[k]);
  return means;
}

}  // namespace rigmap
