#include "raster/upper_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigmap {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

std::uint8_t Rounded(float channel) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0F, 255.0F)));
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

void UpperSurface::Raise(int column, int row, const CellSample& sample) {
  float& top_m = cells_[static_cast<std::size_t>(row) * columns_ + column].top_m;
  top_m = std::max(top_m, sample.height_m - sample.doubt_m);
}

void UpperSurface::Blend(int column, int row, const CellSample& sample) {
  const std::size_t index = static_cast<std::size_t>(row) * columns_ + column;
  Cell& cell = cells_[index];
  if (cell.top_m - (sample.height_m - sample.doubt_m) > layer_m_) return;
  cell.weight += sample.weight;
  cell.above_top_sum += sample.weight * (sample.height_m - cell.top_m);
  for (int i = 0; i < 3; ++i) cell.rgb_sum[i] += sample.weight * sample.rgb[i];
  if (quality_.empty()) return;
  QualitySums& sums = quality_[index];
  sums.variance += sample.weight * sample.sigma_m * sample.sigma_m;
  sums.count += sample.observations;
  for (int i = 0; i < 3; ++i) {
    sums.normal[i] += sample.weight * static_cast<float>(sample.normal[i]);
  }
}

SurfaceGrid UpperSurface::Finish() const {
  SurfaceGrid grid{columns_, rows_, std::vector<float>(cells_.size(), kNothing),
                   std::vector<std::array<std::uint8_t, 3>>(cells_.size()),
                   std::vector<CellQuality>(quality_.size())};
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    if (cell.weight == 0.0F) continue;
    grid.height_m[i] = cell.top_m + cell.above_top_sum / cell.weight;
    for (int k = 0; k < 3; ++k) grid.rgb[i][k] = Rounded(cell.rgb_sum[k] / cell.weight);
    if (quality_.empty()) continue;
    const QualitySums& sums = quality_[i];
    grid.quality[i] = {std::sqrt(sums.variance / cell.weight), sums.count, sums.normal};
  }
  return grid;
}

}  // namespace rigmap
