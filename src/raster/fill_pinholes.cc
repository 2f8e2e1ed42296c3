#include "raster/fill_pinholes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace rigmap {
namespace {

struct Step {
  int columns;
  int rows;
};

constexpr Step kAxes[] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};

struct Neighbour {
  std::size_t index;
  int distance_cells;
};

// Cells whose middle lies in a circle of this diameter.
cv::Mat1b Disc(int diameter) {
  cv::Mat1b disc(diameter, diameter);
  const double middle = 0.5 * (diameter - 1), radius = 0.5 * diameter;
  for (int row = 0; row < diameter; ++row) {
    for (int column = 0; column < diameter; ++column) {
      disc(row, column) = std::hypot(column - middle, row - middle) <= radius ? 1 : 0;
    }
  }
  return disc;
}

// Where empty discs of this diameter can be laid, all of their cells and those beside them: not 0.
cv::Mat1b WideHoles(const SurfaceGrid& grid, int diameter) {
  const int margin = diameter;
  cv::Mat1b wide(grid.rows + 2 * margin, grid.columns + 2 * margin, 255);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (grid.Holds(column, row)) wide(row + margin, column + margin) = 0;
    }
  }
  const cv::Mat1b disc = Disc(diameter);
  // Of each disc that fits the upper left corner, and from there all of it.
  cv::erode(wide, wide, disc, {0, 0}, 1, cv::BORDER_CONSTANT, 255);
  cv::dilate(wide, wide, disc, {diameter - 1, diameter - 1}, 1, cv::BORDER_CONSTANT, 0);
  // Discs of few cells do not fit into all corners of a staircase.
  cv::dilate(wide, wide, cv::Mat1b(3, 3, 1));
  return wide(cv::Rect(margin, margin, grid.columns, grid.rows));
}

std::optional<Neighbour> Nearest(const SurfaceGrid& grid, int column, int row, Step step,
                                 int reach_cells) {
  for (int distance = 1; distance <= reach_cells; ++distance) {
    const int c = column + distance * step.columns, r = row + distance * step.rows;
    if (grid.Holds(c, r)) return Neighbour{grid.Index(c, r), distance};
  }
  return std::nullopt;
}

struct Filling {
  std::size_t index = 0;
  float height_m = 0.0F;
  std::array<float, 3> rgb{};
  CellQuality quality = {};
  float weight = 0.0F;

  // One end of a run.
  void Add(const SurfaceGrid& grid, std::size_t from, float share) {
    weight += share;
    height_m += share * grid.height_m[from];
    for (int i = 0; i < 3; ++i) rgb[i] += share * grid.rgb[from][i];
    if (grid.quality.empty()) return;
    quality.sigma_m += share * grid.quality[from].sigma_m;
    for (int i = 0; i < 3; ++i) quality.normal[i] += share * grid.quality[from].normal[i];
  }
  void WriteTo(SurfaceGrid& grid) const {
    grid.height_m[index] = height_m / weight;
    for (int i = 0; i < 3; ++i) {
      grid.rgb[index][i] = static_cast<std::uint8_t>(std::lround(rgb[i] / weight));
    }
    if (grid.quality.empty()) return;
    CellQuality& filled = grid.quality[index];
    filled = {.sigma_m = quality.sigma_m / weight};
    for (int i = 0; i < 3; ++i) filled.normal[i] = quality.normal[i] / weight;
  }
};

Filling Interpolated(const SurfaceGrid& grid, int column, int row, int reach_cells) {
  Filling filling{grid.Index(column, row)};
  for (const Step step : kAxes) {
    const auto before = Nearest(grid, column, row, {-step.columns, -step.rows}, reach_cells);
    if (!before) continue;
    const auto after = Nearest(grid, column, row, step, reach_cells);
    if (!after) continue;
    const auto cells = static_cast<float>(before->distance_cells + after->distance_cells);
    const float diagonal = step.columns != 0 && step.rows != 0 ? 2.0F : 1.0F;
    const float share = 1.0F / (diagonal * cells * cells * cells);
    filling.Add(grid, before->index, share * static_cast<float>(after->distance_cells));
    filling.Add(grid, after->index, share * static_cast<float>(before->distance_cells));
  }
  return filling;
}

}  // namespace

int FillReach(int max_width_cells) { return 2 * max_width_cells; }

std::size_t FillPinholes(SurfaceGrid& grid, int max_width_cells) {
  if (max_width_cells <= 0 || grid.columns <= 0 || grid.rows <= 0) return 0;
  const cv::Mat1b wide = WideHoles(grid, max_width_cells + 1);
  std::vector<Filling> fillings;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (grid.Holds(column, row) || wide(row, column) != 0) continue;
      const Filling filling = Interpolated(grid, column, row, FillReach(max_width_cells));
      if (filling.weight > 0.0F) fillings.push_back(filling);
    }
  }
  for (const Filling& filling : fillings) filling.WriteTo(grid);
  return fillings.size();
}

}  // namespace rigmap
