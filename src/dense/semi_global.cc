#include "dense/internal/semi_global.h"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <span>
#include <vector>

#include "dense/internal/matching_cost.h"
#include "dense/internal/path_sweep.h"
#include "dense/internal/winner.h"

namespace rigmap {
namespace {

constexpr int kLeastTiles = 2;  // rows of tiles that are held at least

// Of so many rows of tiles, how many are begun from below and left for the next strip.
int OverlapOf(int held) { return std::min(kOverlapTiles, held / 2); }

// The costs of a row of tiles.
struct TileRow {
  hwy::AlignedFreeUniquePtr<std::uint8_t[]> costs, sums_above;
};

class SemiGlobalMatching {
 public:
  SemiGlobalMatching(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                     const DenseOptions& options)
      : windows_(windows),
        options_(options),
        small_step_(CostScale(options).small_step),
        cost_(left, right, windows, options),
        tile_rows_(windows.rows),
        disparities_(windows.size, CV_16S) {
    for (int i = 0; i < windows.rows; ++i) layouts_.emplace_back(windows, i);
  }

  cv::Mat Match(std::size_t volume_bytes) {
    PathSweep down = MakeSweep(PathSweep::Direction::kDown);
    int swept = 0;  // rows of tiles whose costs are held, from `first` on
    for (int first = 0, end = 0; first < windows_.rows; first = end) {
      std::size_t held = VolumeBytes(first, swept);
      while (swept < windows_.rows && (swept - first < kLeastTiles ||
                                       held + VolumeBytes(swept, swept + 1) <= volume_bytes)) {
        held += VolumeBytes(swept, swept + 1);
        Descend(swept++, down);
      }
      end = swept == windows_.rows ? swept : swept - OverlapOf(swept - first);
      Ascend(first, end, swept);
      for (int i = first; i < end; ++i) tile_rows_[i] = {};
    }
    return disparities_;
  }

 private:
  std::size_t VolumeBytes(int first_tile_row, int end_tile_row) const {
    std::size_t bytes = 0;
    for (int i = first_tile_row; i < end_tile_row; ++i) bytes += 2 * layouts_[i].bytes * RowsOf(i);
    return bytes;
  }

  int RowsOf(int tile_row) const {
    constexpr int kTilePx = TileWindows::kTilePx;
    return std::min(kTilePx, windows_.size.height - tile_row * kTilePx);
  }

  PathSweep MakeSweep(PathSweep::Direction direction) const {
    return {direction, windows_.size.width, windows_.LargestCount(), small_step_};
  }

  void Descend(int tile_row, PathSweep& down) {
    const RowLayout& layout = layouts_[tile_row];
    const std::size_t bytes = layout.bytes * RowsOf(tile_row);
    TileRow& tiles = tile_rows_[tile_row];
    tiles.costs = hwy::AllocateAligned<std::uint8_t>(bytes);
    tiles.sums_above = hwy::AllocateAligned<std::uint8_t>(bytes);
    cost_.OfTileRow(tile_row, layout, tiles.costs.get());
    for (int row = 0; row < RowsOf(tile_row); ++row) {
      down.Sweep(layout, tiles.costs.get() + row * layout.bytes,
                 tiles.sums_above.get() + row * layout.bytes);
    }
  }

  // From below `swept` up to `first`; rows below `end` are not complete yet.
  void Ascend(int first, int end, int swept) {
    PathSweep up = MakeSweep(PathSweep::Direction::kUp);
    WinnerRow winners(windows_, options_);
    std::vector<std::uint8_t> sums_below;
    for (int tile_row = swept - 1; tile_row >= first; --tile_row) {
      const RowLayout& layout = layouts_[tile_row];
      sums_below.resize(layout.bytes);
      for (int row = RowsOf(tile_row) - 1; row >= 0; --row) {
        const std::uint8_t* costs = tile_rows_[tile_row].costs.get() + row * layout.bytes;
        up.Sweep(layout, costs, sums_below.data());
        if (tile_row >= end) continue;
        const RowCosts found{&layout, costs,
                             tile_rows_[tile_row].sums_above.get() + row * layout.bytes,
                             sums_below.data()};
        auto* disparities = disparities_.ptr<std::int16_t>(tile_row * TileWindows::kTilePx + row);
        winners.Choose(found, std::span(disparities, disparities_.cols));
      }
    }
  }

  const TileWindows& windows_;
  const DenseOptions& options_;
  int small_step_ = 0;
  MatchingCost cost_;
  std::vector<RowLayout> layouts_;
  std::vector<TileRow> tile_rows_;
  cv::Mat disparities_;
};

}  // namespace

cv::Mat MatchSemiGlobal(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                        const DenseOptions& options, std::size_t volume_bytes) {
  return SemiGlobalMatching(left, right, windows, options).Match(volume_bytes);
}

std::size_t SemiGlobalBytes(const TileWindows& windows, const DenseOptions& options,
                            std::size_t volume_bytes) {
  const int width = windows.size.width, count = windows.LargestCount();
  std::size_t whole = 0, largest_strip = 0;
  std::vector<std::size_t> of_tile_row;
  for (int i = 0; i < windows.rows; ++i) {
    std::size_t row_bytes = 0;
    for (int x = 0; x < width; ++x) row_bytes += windows.At(x / TileWindows::kTilePx, i).count;
    of_tile_row.push_back(2 * row_bytes * TileWindows::kTilePx);
    whole += of_tile_row.back();
    const std::size_t row_before = i == 0 ? 0 : of_tile_row[i - 1];
    largest_strip = std::max(largest_strip, row_before + of_tile_row[i]);
  }
  const std::size_t volume = std::min(whole, std::max(volume_bytes, largest_strip));
  const std::size_t layouts = static_cast<std::size_t>(windows.rows) * width * 16;
  const std::size_t disparities = windows.size.area() * sizeof(std::int16_t);
  return volume + 2 * PathSweep::BytesOf(width, count) + layouts + disparities +
         MatchingCost::WorkBytes(windows, options) +
         static_cast<std::size_t>(width) * (count + WinnerRow::kBytesPerColumn);
}

}  // namespace rigmap
