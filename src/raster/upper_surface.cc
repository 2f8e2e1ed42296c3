#include "raster/upper_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rigmap {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

std::uint8_t Rounded(float channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0F, 255.0F)));
}

struct Neighbour {
  std::size_t index;
  int distance_cells;
};

struct Step {
  int columns;
  int rows;
};

std::optional<Neighbour> Nearest(const SurfaceGrid& grid, int column, int row, Step step,
                                 int reach_cells) {
  for (int distance = 1; distance <= reach_cells; ++distance) {
    const int c = column + distance * step.columns, r = row + distance * step.rows;
    if (grid.Holds(c, r)) return Neighbour{grid.Index(c, r), distance};
  }
  return std::nullopt;
}

// The seen cells at both ends of the run of empty cells through this one, if it is short.
struct Run {
  Neighbour before;
  Neighbour after;

  int Cells() const { return before.distance_cells + after.distance_cells - 1; }
};
std::optional<Run> RunThrough(const SurfaceGrid& grid, int column, int row, Step step,
                              int max_cells) {
  const auto before = Nearest(grid, column, row, {-step.columns, -step.rows}, max_cells);
  if (!before) return std::nullopt;
  const int left_cells = max_cells + 1 - before->distance_cells;
  const auto after = Nearest(grid, column, row, step, left_cells);
  if (!after) return std::nullopt;
  return Run{*before, *after};
}

struct Filling {
  std::size_t index;
  float height_m;
  std::array<std::uint8_t, 3> rgb;
  CellQuality quality = {};
};

Filling Interpolated(const SurfaceGrid& grid, std::size_t index, const std::array<Run, 2>& runs) {
  Filling filling{index, 0.0F, {}};
  std::array<float, 3> rgb{};
  const auto add = [&](const Neighbour& from, const Neighbour& opposite) {
    const float share = 0.5F * static_cast<float>(opposite.distance_cells) /
                        static_cast<float>(from.distance_cells + opposite.distance_cells);
    filling.height_m += share * grid.height_m[from.index];
    for (int i = 0; i < 3; ++i) rgb[i] += share * grid.rgb[from.index][i];
    if (grid.quality.empty()) return;
    const CellQuality& quality = grid.quality[from.index];
    filling.quality.sigma_m += share * quality.sigma_m;
    for (int i = 0; i < 3; ++i) filling.quality.normal[i] += share * quality.normal[i];
  };
  for (const Run& run : runs) {
    add(run.before, run.after);
    add(run.after, run.before);
  }
  std::transform(rgb.begin(), rgb.end(), filling.rgb.begin(), Rounded);
  return filling;
}

}  // namespace

bool SurfaceGrid::Holds(int column, int row) const {
  return column >= 0 && column < columns && row >= 0 && row < rows &&
         !std::isnan(height_m[Index(column, row)]);
}

UpperSurface::UpperSurface(int columns, int rows, double layer_m, bool with_quality)
    : columns_(columns),
      rows_(rows),
      layer_m_(static_cast<float>(layer_m)),
      cells_(static_cast<std::size_t>(columns) * rows,
             Cell{-std::numeric_limits<float>::infinity()}),
      quality_(with_quality ? cells_.size() : 0) {}

void UpperSurface::Raise(int column, int row, float height_m) {
  float& top_m = cells_[static_cast<std::size_t>(row) * columns_ + column].top_m;
  top_m = std::max(top_m, height_m);
}

void UpperSurface::Blend(int column, int row, float height_m,
                         const std::array<std::uint8_t, 3>& rgb, std::uint16_t observations,
                         const PointQuality& quality) {
  const std::size_t index = static_cast<std::size_t>(row) * columns_ + column;
  Cell& cell = cells_[index];
  const float depth_m = cell.top_m - height_m;
  if (depth_m > layer_m_) return;
  const float weight = std::max<float>(1.0F, observations);
  cell.weight += weight;
  cell.depth_sum += weight * depth_m;
  for (int i = 0; i < 3; ++i) cell.rgb_sum[i] += weight * rgb[i];
  if (quality_.empty()) return;
  QualitySums& sums = quality_[index];
  sums.variance += weight * quality.sigma_m * quality.sigma_m;
  sums.count += observations;
  for (int i = 0; i < 3; ++i) sums.normal[i] += weight * static_cast<float>(quality.normal[i]);
}

SurfaceGrid UpperSurface::Finish() const {
  SurfaceGrid grid{columns_, rows_, std::vector<float>(cells_.size(), kNothing),
                   std::vector<std::array<std::uint8_t, 3>>(cells_.size()),
                   std::vector<CellQuality>(quality_.size())};
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    if (cell.weight == 0.0F) continue;
    grid.height_m[i] = cell.top_m - cell.depth_sum / cell.weight;
    for (int k = 0; k < 3; ++k) grid.rgb[i][k] = Rounded(cell.rgb_sum[k] / cell.weight);
    if (quality_.empty()) continue;
    const QualitySums& sums = quality_[i];
    grid.quality[i] = {std::sqrt(sums.variance / cell.weight), sums.count, sums.normal};
  }
  return grid;
}

std::size_t FillPinholes(SurfaceGrid& grid, int max_width_cells, int max_length_cells) {
  std::vector<Filling> fillings;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (grid.Holds(column, row)) continue;
      const auto along_row = RunThrough(grid, column, row, {1, 0}, max_length_cells);
      if (!along_row) continue;
      const auto along_column = RunThrough(grid, column, row, {0, 1}, max_length_cells);
      if (!along_column) continue;
      if (std::min(along_row->Cells(), along_column->Cells()) > max_width_cells) continue;
      fillings.push_back(Interpolated(grid, grid.Index(column, row), {*along_row, *along_column}));
    }
  }
  for (const Filling& filling : fillings) {
    grid.height_m[filling.index] = filling.height_m;
    grid.rgb[filling.index] = filling.rgb;
    if (!grid.quality.empty()) grid.quality[filling.index] = filling.quality;
  }
  return fillings.size();
}

}  // namespace rigmap
