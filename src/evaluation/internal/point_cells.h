// Points by the cubes of a grid in which they lie.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rigmap {

struct PointCells {
  std::vector<std::uint32_t> of_point;  // the number of each point's cell
  std::vector<std::size_t> sizes;       // points of each cell, none of them 0
};

// Cells have the side `size_m`, and corners at multiples of it. Points must be finite.
PointCells SortIntoCells(std::span<const Eigen::Vector3d> points, double size_m);

// Squares instead: whatever the height.
PointCells SortIntoColumns(std::span<const Eigen::Vector3d> points, double size_m);

// The mean of each cell's values; one value a point.
std::vector<double> MeansOfCells(const PointCells& cells, std::span<const double> values);

}  // namespace rigmap
