// Which disparities a pixel is searched at: those of its tile.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace rigmap {

// Disparities first <= d < first + count, px.
struct DisparityWindow {
  // Counts are multiples of this: as many 8 bit costs as the kernels take at a time.
  static constexpr int kGrain = 32;

  int first = 0;
  int count = kGrain;

  int End() const { return first + count; }
};

// The windows of an image, in tiles of kTilePx x kTilePx pixels; the last ones may be cut.
struct TileWindows {
  static constexpr int kTilePx = 16;

  cv::Size size;                         // of the image, px
  int columns = 0, rows = 0;             // of tiles
  std::vector<DisparityWindow> windows;  // row by row

  TileWindows() = default;
  TileWindows(cv::Size image_size, const DisparityWindow& window);

  const DisparityWindow& At(int tile_column, int tile_row) const {
    return windows[static_cast<std::size_t>(tile_row) * columns + tile_column];
  }
  DisparityWindow& At(int tile_column, int tile_row) {
    return windows[static_cast<std::size_t>(tile_row) * columns + tile_column];
  }
  int End() const;           // beyond the largest disparity searched
  int LargestCount() const;  // px
};

// From 0 to at least `range_px`, everywhere.
TileWindows WholeRange(cv::Size size, int range_px);

// Around what was found at half the resolution (CV_16S, in steps of 1/16 px, negative where
// unknown): a tile's window holds all disparities that were found in it and in the tiles around it,
// and a margin. Where nothing was found, those of the nearest tiles; nothing if there are none.
std::optional<TileWindows> WindowsAround(const cv::Mat& half_disparity, cv::Size size);

// How the costs of one pixel row lie in memory: column by column, each as many as its window has.
// The same for all pixel rows of a row of tiles.
struct RowLayout {
  std::vector<int> first, count;    // of each column's window
  std::vector<std::size_t> offset;  // of each column's first cost
  std::size_t bytes = 0;            // with one byte per cost

  RowLayout() = default;
  RowLayout(const TileWindows& windows, int tile_row);
};

}  // namespace rigmap
