#include "dense/internal/disparity_windows.h"

#include <algorithm>

namespace rigmap {
namespace {

int TilesAlong(int pixels) { return (pixels + TileWindows::kTilePx - 1) / TileWindows::kTilePx; }

int InGrains(int disparities) {
  constexpr int kGrain = DisparityWindow::kGrain;
  return std::max(1, (disparities + kGrain - 1) / kGrain) * kGrain;
}

}  // namespace

TileWindows::TileWindows(cv::Size image_size, const DisparityWindow& window)
    : size(image_size),
      columns(TilesAlong(size.width)),
      rows(TilesAlong(size.height)),
      windows(static_cast<std::size_t>(columns) * rows, window) {}

int TileWindows::End() const {
  int end = 0;
  for (const DisparityWindow& window : windows) end = std::max(end, window.End());
  return end;
}

int TileWindows::LargestCount() const {
  int count = 0;
  for (const DisparityWindow& window : windows) count = std::max(count, window.count);
  return count;
}

TileWindows WholeRange(cv::Size size, int range_px) {
  return {size, {.first = 0, .count = InGrains(range_px + 1)}};
}

RowLayout::RowLayout(const TileWindows& windows, int tile_row) {
  for (int column = 0; column < windows.size.width; ++column) {
    const DisparityWindow& window = windows.At(column / TileWindows::kTilePx, tile_row);
    first.push_back(window.first);
    count.push_back(window.count);
    offset.push_back(bytes);
    bytes += window.count;
  }
}

}  // namespace rigmap
