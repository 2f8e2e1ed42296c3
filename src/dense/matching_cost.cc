#include "dense/internal/matching_cost.h"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "dense/internal/view_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/matching_cost.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RIGMAP_DENSE_MATCHING_COST
#define RIGMAP_DENSE_MATCHING_COST
namespace rigmap {

// A tile, and where its costs go.
struct CostTile {
  int first_column = 0, end_column = 0;
  int rows = 0;
  DisparityWindow window;
  std::uint8_t* costs = nullptr;  // of its first pixel
  std::size_t bytes_per_row = 0;  // from pixel row to pixel row
};

struct TileWork {
  std::uint8_t* pixel = nullptr;    // costs of a row of pixels
  std::uint16_t* across = nullptr;  // sums over a block's columns, of as many rows as it has
  std::uint16_t* block = nullptr;   // sums over blocks
};

}  // namespace rigmap
#endif

HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Costs in bytes, and half as many sums.
using Bytes = hn::CappedTag<std::uint8_t, DisparityWindow::kGrain>;
using Sums = hn::Repartition<std::uint16_t, Bytes>;
using HalfBytes = hn::Half<Bytes>;

template <class Vector>
Vector Dissimilarity(const MeasuredRow& left, const MeasuredRow& right, int column, int index) {
  const Bytes bytes;
  const auto one = hn::Set(bytes, left.value[column]),
             other = hn::LoadU(bytes, right.value + index);
  const auto to_other = hn::Max(hn::SaturatedSub(one, hn::LoadU(bytes, right.most + index)),
                                hn::SaturatedSub(hn::LoadU(bytes, right.least + index), one));
  const auto to_one = hn::Max(hn::SaturatedSub(other, hn::Set(bytes, left.most[column])),
                              hn::SaturatedSub(hn::Set(bytes, left.least[column]), other));
  return hn::Min(to_other, to_one);
}

// Costs of single pixels of a row, of a tile's columns and `radius` to either side.
void ComparePixels(const ViewRows& views, int row, const CostTile& tile, int radius,
                   std::uint8_t* costs) {
  const Bytes bytes;
  const ViewRow &left = views.left[row], &right = views.right[row];
  for (int x = tile.first_column - radius; x < tile.end_column + radius; ++x) {
    const int column = std::clamp(x, 0, views.width - 1);
    const int first = views.width - 1 - column + tile.window.first;
    for (int i = 0; i < tile.window.count; i += static_cast<int>(hn::Lanes(bytes))) {
      using Vector = decltype(hn::Zero(bytes));
      const auto gradient = Dissimilarity<Vector>(left[0], right[0], column, first + i);
      const auto grey = Dissimilarity<Vector>(left[1], right[1], column, first + i);
      hn::Store(hn::Add(gradient, hn::ShiftRight<MatchingCost::kGreyShift>(grey)), bytes,
                costs + i);
    }
    costs += tile.window.count;
  }
}

// Moves the blocks of a tile down by one row of pixels: `across` holds the sums of the row that
// leaves them, and those of the one that enters them afterwards.
void MoveBlocks(const CostTile& tile, int radius, const std::uint8_t* pixel, std::uint16_t* across,
                std::uint16_t* block) {
  const Sums sums;
  const HalfBytes half;
  const int count = tile.window.count, columns = tile.end_column - tile.first_column;
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(sums))) {
    const auto cost_at = [&](int column) {
      return hn::PromoteTo(sums, hn::LoadU(half, pixel + column * count + i));
    };
    auto sum = hn::Zero(sums);
    for (int column = 0; column < 2 * radius; ++column) sum = hn::Add(sum, cost_at(column));
    for (int column = 0; column < columns; ++column) {
      sum = hn::Add(sum, cost_at(column + 2 * radius));
      std::uint16_t *leaves = across + column * count + i, *total = block + column * count + i;
      const auto moved = hn::Sub(hn::Add(hn::Load(sums, total), sum), hn::Load(sums, leaves));
      hn::Store(moved, sums, total);
      hn::Store(sum, sums, leaves);
      sum = hn::Sub(sum, cost_at(column));
    }
  }
}

void WriteCosts(const CostTile& tile, const CostScale& scale, const std::uint16_t* block,
                std::uint8_t* costs) {
  const Sums sums;
  const HalfBytes half;
  const hn::RebindToSigned<Sums> signed_sums;
  const auto factor = hn::Set(sums, static_cast<std::uint16_t>(scale.multiplier));
  const auto most = hn::Set(sums, static_cast<std::uint16_t>(CostScale::kMostCost));
  const int all = (tile.end_column - tile.first_column) * tile.window.count;
  for (int i = 0; i < all; i += static_cast<int>(hn::Lanes(sums))) {
    const auto sum = hn::Load(sums, block + i);
    const auto twice = hn::SaturatedAdd(sum, sum);
    const auto scaled = hn::Min(hn::MulHigh(hn::SaturatedAdd(twice, twice), factor), most);
    hn::StoreU(hn::DemoteTo(half, hn::BitCast(signed_sums, scaled)), half, costs + i);
  }
}

void CompareTile(const ViewRows& views, const CostTile& tile, int radius, const CostScale& scale,
                 const TileWork& work) {
  const int block = 2 * radius + 1;
  const std::size_t entries =
      static_cast<std::size_t>(tile.end_column - tile.first_column) * tile.window.count;
  std::fill_n(work.across, block * entries, std::uint16_t{0});
  std::fill_n(work.block, entries, std::uint16_t{0});
  for (int row = 0; row < tile.rows + 2 * radius; ++row) {
    ComparePixels(views, row, tile, radius, work.pixel);
    MoveBlocks(tile, radius, work.pixel, work.across + row % block * entries, work.block);
    if (row >= 2 * radius) {
      WriteCosts(tile, scale, work.block, tile.costs + (row - 2 * radius) * tile.bytes_per_row);
    }
  }
}

HWY_NOINLINE void CompareTileRow(const ViewRows& views, std::span<const CostTile> tiles, int radius,
                                 const CostScale& scale, const TileWork& work) {
  for (const CostTile& tile : tiles) CompareTile(views, tile, radius, scale, work);
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {
namespace {

HWY_EXPORT(CompareTileRow);

constexpr std::size_t kAlignment = HWY_ALIGNMENT;

// Hands out parts of one piece of memory; only adds them up before there is any.
class Parts {
 public:
  Parts() = default;
  explicit Parts(std::uint8_t* memory) : memory_(memory) {}
  template <class Value>
  Value* Take(std::size_t count) {
    auto* part = memory_ == nullptr ? nullptr : reinterpret_cast<Value*>(memory_ + bytes_);
    bytes_ += (count * sizeof(Value) + kAlignment - 1) / kAlignment * kAlignment;
    return part;
  }
  std::size_t Bytes() const { return bytes_; }

 private:
  std::uint8_t* memory_ = nullptr;
  std::size_t bytes_ = 0;
};

struct CostWork {
  ViewRows views;
  TileWork tile;
};

MeasuredRow TakeRow(Parts& parts, std::size_t width) {
  return {parts.Take<std::uint8_t>(width), parts.Take<std::uint8_t>(width),
          parts.Take<std::uint8_t>(width)};
}

CostWork TakeWork(Parts& parts, const TileWindows& windows, int radius) {
  const int width = windows.size.width, count = windows.LargestCount(), block = 2 * radius + 1;
  const std::size_t entries = static_cast<std::size_t>(TileWindows::kTilePx) * count;
  const std::size_t reversed = static_cast<std::size_t>(width) + windows.End();
  CostWork work;
  work.views.width = width;
  for (int row = 0; row < TileWindows::kTilePx + 2 * radius; ++row) {
    work.views.left.push_back({TakeRow(parts, width), TakeRow(parts, width)});
    work.views.right.push_back({TakeRow(parts, reversed), TakeRow(parts, reversed)});
  }
  work.tile.pixel =
      parts.Take<std::uint8_t>(entries + 2 * static_cast<std::size_t>(radius) * count);
  work.tile.across = parts.Take<std::uint16_t>(block * entries);
  work.tile.block = parts.Take<std::uint16_t>(entries);
  return work;
}

}  // namespace

CostScale::CostScale(const DenseOptions& options) {
  const double area = options.block_px * options.block_px;
  const double per_cost = kLargeStep / (options.large_step_cost * area);
  multiplier = std::clamp(static_cast<int>(std::lround(per_cost * 65536.0 / 4.0)), 1, 65535);
  small_step = std::clamp(static_cast<int>(std::lround(per_cost * options.small_step_cost * area)),
                          1, kLargeStep);
}

MatchingCost::MatchingCost(const cv::Mat& left, const cv::Mat& right, const TileWindows& windows,
                           const DenseOptions& options)
    : left_(left),
      right_(right),
      windows_(windows),
      radius_(options.block_px / 2),
      work_bytes_(WorkBytes(windows, options)),
      scale_(options) {}

std::size_t MatchingCost::WorkBytes(const TileWindows& windows, const DenseOptions& options) {
  Parts parts;
  TakeWork(parts, windows, options.block_px / 2);
  return parts.Bytes();
}

void MatchingCost::OfTileRow(int tile_row, const RowLayout& layout, std::uint8_t* costs) const {
  const auto memory = hwy::AllocateAligned<std::uint8_t>(work_bytes_);
  Parts parts(memory.get());
  const CostWork work = TakeWork(parts, windows_, radius_);
  const int first_row = tile_row * TileWindows::kTilePx;
  const int reversed_width = windows_.size.width + windows_.End();
  const int rows = std::min(TileWindows::kTilePx, windows_.size.height - first_row);
  for (int i = 0; i < rows + 2 * radius_; ++i) {
    const int row = std::clamp(first_row + i - radius_, 0, windows_.size.height - 1);
    MeasureRow(left_, row, work.views.left[i]);
    MeasureReversed(right_, row, reversed_width, work.views.right[i]);
  }
  std::vector<CostTile> tiles;
  for (int i = 0; i < windows_.columns; ++i) {
    const int column = i * TileWindows::kTilePx;
    tiles.push_back({.first_column = column,
                     .end_column = std::min(column + TileWindows::kTilePx, windows_.size.width),
                     .rows = rows,
                     .window = windows_.At(i, tile_row),
                     .costs = costs + layout.offset[column],
                     .bytes_per_row = layout.bytes});
  }
  HWY_DYNAMIC_DISPATCH(CompareTileRow)(work.views, tiles, radius_, scale_, work.tile);
}

}  // namespace rigmap
#endif
