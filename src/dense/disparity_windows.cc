#include "dense/internal/disparity_windows.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace rigmap {
namespace {

int TilesAlong(int pixels) { return (pixels + TileWindows::kTilePx - 1) / TileWindows::kTilePx; }

int InGrains(int disparities) {
  constexpr int kGrain = DisparityWindow::kGrain;
  return std::max(1, (disparities + kGrain - 1) / kGrain) * kGrain;
}

// What was found at the pixels of a tile, at half the resolution.
struct FoundRange {
  int least = std::numeric_limits<int>::max();  // steps
  int most = std::numeric_limits<int>::min();

  bool IsEmpty() const { return least > most; }
  void Add(int steps) {
    least = std::min(least, steps);
    most = std::max(most, steps);
  }
  void Add(const FoundRange& other) {
    least = std::min(least, other.least);
    most = std::max(most, other.most);
  }
};

class FoundRanges {
 public:
  FoundRanges(int columns, int rows) : columns_(columns), rows_(rows), ranges_(columns * rows) {}
  FoundRange& At(int column, int row) { return ranges_[row * columns_ + column]; }
  const FoundRange& At(int column, int row) const { return ranges_[row * columns_ + column]; }
  FoundRange Around(int column, int row) const {
    FoundRange around;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows_ - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns_ - 1); ++x) {
        around.Add(At(x, y));
      }
    }
    return around;
  }
  // Each joined with those around it; or only the empty ones.
  FoundRanges Grown(bool only_empty) const {
    FoundRanges grown = *this;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (!only_empty || At(column, row).IsEmpty()) grown.At(column, row) = Around(column, row);
      }
    }
    return grown;
  }
  bool HasEmpty() const { return std::ranges::any_of(ranges_, &FoundRange::IsEmpty); }
  bool AllEmpty() const { return std::ranges::all_of(ranges_, &FoundRange::IsEmpty); }

 private:
  int columns_ = 0, rows_ = 0;
  std::vector<FoundRange> ranges_;
};

FoundRanges RangesOfTiles(const cv::Mat& half_disparity, const TileWindows& windows) {
  FoundRanges ranges(windows.columns, windows.rows);
  constexpr int kHalfTile = TileWindows::kTilePx / 2;
  for (int row = 0; row < half_disparity.rows; ++row) {
    const auto* steps = half_disparity.ptr<std::int16_t>(row);
    const int tile_row = std::min(row / kHalfTile, windows.rows - 1);
    for (int column = 0; column < half_disparity.cols; ++column) {
      if (steps[column] < 0) continue;
      ranges.At(std::min(column / kHalfTile, windows.columns - 1), tile_row).Add(steps[column]);
    }
  }
  return ranges;
}

// At twice the resolution.
DisparityWindow WindowAround(const FoundRange& found) {
  constexpr int kFineSteps = 16 / 2;  // a step at half the resolution is two here
  constexpr int kMarginPx = 4;        // an error of 1.5 px at half the resolution, and a neighbour
  const int least = found.least / kFineSteps - kMarginPx,
            most = found.most / kFineSteps + 1 + kMarginPx;
  const int count = InGrains(most - std::max(least, 0) + 1);
  return {.first = std::max(0, (least + most + 1 - count) / 2), .count = count};
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

std::optional<TileWindows> WindowsAround(const cv::Mat& half_disparity, cv::Size size) {
  TileWindows windows(size, DisparityWindow());
  FoundRanges ranges = RangesOfTiles(half_disparity, windows).Grown(false);
  if (ranges.AllEmpty()) return std::nullopt;
  while (ranges.HasEmpty()) ranges = ranges.Grown(true);
  for (int row = 0; row < windows.rows; ++row) {
    for (int column = 0; column < windows.columns; ++column) {
      windows.At(column, row) = WindowAround(ranges.At(column, row));
    }
  }
  return windows;
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
