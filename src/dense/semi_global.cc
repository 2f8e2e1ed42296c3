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

  cv::Mat Match() {
    PathSweep down = MakeSweep(PathSweep::Direction::kDown);
    for (int i = 0; i < windows_.rows; ++i) Descend(i, down);
    Ascend(0, windows_.rows);
    return disparities_;
  }

 private:
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

  void Ascend(int first_tile_row, int end_tile_row) {
    PathSweep up = MakeSweep(PathSweep::Direction::kUp);
    WinnerRow winners(windows_.size.width, windows_.LargestCount(), options_);
    std::vector<std::uint8_t> sums_below;
    for (int tile_row = end_tile_row - 1; tile_row >= first_tile_row; --tile_row) {
      const RowLayout& layout = layouts_[tile_row];
      sums_below.resize(layout.bytes);
      for (int row = RowsOf(tile_row) - 1; row >= 0; --row) {
        const std::uint8_t* costs = tile_rows_[tile_row].costs.get() + row * layout.bytes;
        up.Sweep(layout, costs, sums_below.data());
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
                        const DenseOptions& options) {
  return SemiGlobalMatching(left, right, windows, options).Match();
}

}  // namespace rigmap
