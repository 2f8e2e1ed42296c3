#include "evaluation/internal/rock_sheets.h"

#include <algorithm>
#include <vector>

#include "evaluation/internal/point_cells.h"

namespace rigmap {
namespace {

constexpr double kCube_m = 0.03;  // small enough to be flat against a gap
constexpr double kGap_m = 0.01;   // a voxel of the map
constexpr std::size_t kMinPointsOfCube = 4;
constexpr double kMinShareOfSheet = 0.2;
constexpr double kMinPointsOfSheet = 2.0;

bool IsInTwoSheets(std::vector<double> offset_m) {
  std::ranges::sort(offset_m);
  const auto count = static_cast<double>(offset_m.size());
  const double least = std::max(kMinPointsOfSheet, kMinShareOfSheet * count);
  for (std::size_t below = 1; below < offset_m.size(); ++below) {
    const auto points = static_cast<double>(below);
    const bool both = points >= least && count - points >= least;
    if (both && offset_m[below] - offset_m[below - 1] > kGap_m) return true;
  }
  return false;
}

}  // namespace

double ShareInTwoSheets(std::span<const Eigen::Vector3d> x_true, std::span<const double> offset_m) {
  const PointCells cubes = SortIntoCells(x_true, kCube_m);
  std::vector<std::vector<double>> offsets_of(cubes.sizes.size());
  for (std::size_t i = 0; i < x_true.size(); ++i) {
    offsets_of[cubes.of_point[i]].push_back(offset_m[i]);
  }
  std::erase_if(offsets_of, [](const auto& offsets) { return offsets.size() < kMinPointsOfCube; });
  if (offsets_of.empty()) return 0.0;
  const auto doubled = std::ranges::count_if(offsets_of, IsInTwoSheets);
  return static_cast<double>(doubled) / static_cast<double>(offsets_of.size());
}

}  // namespace rigmap
