// What is seen of a cloud from straight above, on a grid of cells. "Above" is whatever the caller
// takes for the height: z for maps, nearness to the viewer for pictures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigmap {

// What is known of a cell besides height and colour.
struct CellQuality {
  float sigma_m = 0.0F;                  // root of the mean variance of its points
  float count = 0.0F;                    // depth pixels merged; 0: filled in
  std::array<float, 3> normal{0, 0, 0};  // sum of its points' normals
  float view_deg = 0.0F;                 // filled by whoever knows the cameras; NaN: by none
};

struct SurfaceGrid {
  int columns = 0;
  int rows = 0;
  std::vector<float> height_m;                   // row by row; NaN where nothing was seen
  std::vector<std::array<std::uint8_t, 3>> rgb;  // black there
  std::vector<CellQuality> quality = {};         // of seen cells; empty where none was asked for

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
  bool Holds(int column, int row) const;  // inside, and something was seen
};

// What a point says about a cell.
struct CellSample {
  float height_m = 0.0F;
  float doubt_m = 0.0F;  // it hides what is finer only where it is higher than that by this much
  std::array<std::uint8_t, 3> rgb{};
  float weight = 1.0F;  // > 0
  float observations = 0.0F;
  float sigma_m = 0.0F;
  std::array<std::int8_t, 3> normal{};  // times 127
};

// A cell's height and colour are the weighted means of its points within `layer_m` below the
// highest, each taken for lower by its doubt: points farther down are covered, and of two that may
// be the same surface that which is known better is seen. The points must be given twice, first all
// to Raise, then all to Blend. 28 bytes a cell, 20 more with quality. Cells must lie inside the
// grid.
class UpperSurface {
 public:
  UpperSurface(int columns, int rows, double layer_m, bool with_quality = false);

  void Raise(int column, int row, const CellSample& sample);
  void Blend(int column, int row, const CellSample& sample);
  SurfaceGrid Finish() const;

 private:
  struct Cell {
    float top_m;                 // minus infinity: no point
    float weight = 0.0F;         // of the top layer, as the sums
    float above_top_sum = 0.0F;  // of metres
    std::array<float, 3> rgb_sum{};
  };

  struct QualitySums {
    float variance = 0.0F;  // weighted
    float count = 0.0F;
    std::array<float, 3> normal{};
  };

  int columns_;
  int rows_;
  float layer_m_;
  std::vector<Cell> cells_;
  std::vector<QualitySums> quality_;
};

}  // namespace rigmap
