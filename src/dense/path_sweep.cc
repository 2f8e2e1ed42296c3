#include "dense/internal/path_sweep.h"

#include <algorithm>
#include <utility>

#include "dense/internal/matching_cost.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/path_sweep.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RIGMAP_DENSE_PATH_SWEEP
#define RIGMAP_DENSE_PATH_SWEEP
namespace rigmap {

constexpr int kPaths = 4;

// Aggregated costs of the pixel before on a path.
struct PathEnd {
  const std::uint8_t* costs = nullptr;  // at the first disparity of its window
  int first = 0, count = 0;
  std::uint8_t least = 0;
};

// Where those of a pixel go.
struct PathOutput {
  std::uint8_t* costs = nullptr;
  std::uint8_t* least = nullptr;
};

struct PixelStep {
  std::array<PathEnd, kPaths> before;
  std::array<PathOutput, kPaths> here;
  int first = 0, count = 0;
  const std::uint8_t* costs = nullptr;
  std::uint8_t* sums = nullptr;
};

struct RowSweep {
  int columns = 0;
  int step = 1;  // from column to column
  int small_step = 0;
  const RowLayout *layout = nullptr, *layout_before = nullptr;
  const std::uint8_t* costs = nullptr;
  std::uint8_t* sums = nullptr;
  std::array<PathLine, 3>*before = nullptr, *here = nullptr;
  PathLine* along = nullptr;
  const std::uint8_t* zeros = nullptr;

  // Path 0 comes along the row; the others from the row before: the column before, this, the next.
  PathEnd Before(int path, int column) const {
    const int from = column + (path - 2 + (path == 0)) * step;
    const RowLayout* layout_there = path == 0 ? layout : layout_before;
    if (layout_there == nullptr || from < 0 || from >= columns) {
      return {zeros, layout->first[column], layout->count[column], 0};
    }
    PathLine& line = path == 0 ? *along : (*before)[path - 1];
    const int slot = path == 0 ? from % 2 : from;
    return {line.Costs(slot), layout_there->first[from], layout_there->count[from],
            line.Least(slot)};
  }
  PathOutput Here(int path, int column) const {
    PathLine& line = path == 0 ? *along : (*here)[path - 1];
    const int slot = path == 0 ? column % 2 : column;
    return {line.Costs(slot), &line.Least(slot)};
  }
};

}  // namespace rigmap
#endif

HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Costs = hn::CappedTag<std::uint8_t, DisparityWindow::kGrain>;
using CostVector = hn::Vec<Costs>;

// A vector's least cost, by way of pairs as 16 bit, for which there is an instruction.
HWY_INLINE std::uint8_t LeastOf(CostVector costs) {
#if HWY_TARGET == HWY_SCALAR
  return hn::GetLane(costs);
#else
  const Costs tag;
  const hn::Repartition<std::uint16_t, Costs> pairs;
  const auto high = hn::BitCast(tag, hn::ShiftRight<8>(hn::BitCast(pairs, costs)));
  // The upper byte of each pair becomes 0.
  const auto least = hn::BitCast(pairs, hn::Min(costs, high));
  return static_cast<std::uint8_t>(hn::GetLane(hn::MinOfLanes(pairs, least)));
#endif
}

// m(p, d) for a vector of disparities that begin `ahead` of the window's first.
HWY_INLINE CostVector StepFrom(const PathEnd& before, int ahead, CostVector small_step,
                               CostVector large_step) {
  const Costs tag;
  // Beyond these all is large.
  const int shift = std::clamp(ahead, -DisparityWindow::kGrain - 1, before.count + 1);
  const std::uint8_t* costs = before.costs + shift;
  const auto least = hn::Set(tag, before.least);
  const auto stepped = hn::SaturatedAdd(
      hn::Min(hn::LoadU(tag, costs - 1), hn::LoadU(tag, costs + 1)), small_step);
  const auto best = hn::Min(hn::Min(hn::LoadU(tag, costs), stepped), hn::Add(least, large_step));
  return hn::Sub(best, least);
}

HWY_INLINE void SweepPixel(const PixelStep& pixel, CostVector small_step, CostVector large_step) {
  const Costs tag;
  auto least0 = hn::Set(tag, 255), least1 = least0, least2 = least0, least3 = least0;
  for (int i = 0; i < pixel.count; i += static_cast<int>(hn::Lanes(tag))) {
    const auto cost = hn::LoadU(tag, pixel.costs + i);
    auto sum = hn::Zero(tag);
    const auto follow = [&](int path, CostVector& least) HWY_ATTR {
      const PathEnd& before = pixel.before[path];
      const auto step =
          StepFrom(before, pixel.first - before.first + i, small_step, large_step);
      const auto aggregated = hn::Add(cost, step);
      sum = hn::Add(sum, step);
      least = hn::Min(least, aggregated);
      hn::StoreU(aggregated, tag, pixel.here[path].costs + i);
    };
    follow(0, least0);
    follow(1, least1);
    follow(2, least2);
    follow(3, least3);
    hn::StoreU(sum, tag, pixel.sums + i);
  }
  *pixel.here[0].least = LeastOf(least0);
  *pixel.here[1].least = LeastOf(least1);
  *pixel.here[2].least = LeastOf(least2);
  *pixel.here[3].least = LeastOf(least3);
  // The slots along the row change their windows from tile to tile.
  for (int i = 0; i < 2 * DisparityWindow::kGrain; i += static_cast<int>(hn::Lanes(tag))) {
    hn::StoreU(hn::Set(tag, 255), tag, pixel.here[0].costs + pixel.count + i);
  }
}

HWY_NOINLINE void SweepRow(const RowSweep& row) {
  const Costs tag;
  const auto small_step = hn::Set(tag, static_cast<std::uint8_t>(row.small_step));
  const auto large_step = hn::Set(tag, static_cast<std::uint8_t>(CostScale::kLargeStep));
  for (int i = 0; i < row.columns; ++i) {
    const int column = row.step > 0 ? i : row.columns - 1 - i;
    PixelStep pixel;
    for (int path = 0; path < kPaths; ++path) {
      pixel.before[path] = row.Before(path, column);
      pixel.here[path] = row.Here(path, column);
    }
    pixel.first = row.layout->first[column];
    pixel.count = row.layout->count[column];
    pixel.costs = row.costs + row.layout->offset[column];
    pixel.sums = row.sums + row.layout->offset[column];
    SweepPixel(pixel, small_step, large_step);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(SweepRow);

int PathLine::StrideOf(int largest_count) { return (kBefore + largest_count + kBehind + 63) / 64 * 64; }

std::size_t PathLine::BytesOf(int columns, int largest_count) {
  return static_cast<std::size_t>(columns) * (StrideOf(largest_count) + 1);
}

PathLine::PathLine(int columns, int largest_count)
    : stride_(StrideOf(largest_count)),
      costs_(hwy::AllocateAligned<std::uint8_t>(columns * stride_)),
      least_(columns) {
  std::fill_n(costs_.get(), columns * stride_, std::uint8_t{255});
}

void PathLine::Clear(const RowLayout& layout) {
  for (std::size_t column = 0; column < least_.size(); ++column) {
    std::fill_n(Costs(static_cast<int>(column)) + layout.count[column], kBehind, std::uint8_t{255});
  }
}

namespace {

std::array<PathLine, 3> ThreeLines(int columns, int largest_count) {
  return {PathLine(columns, largest_count), PathLine(columns, largest_count),
          PathLine(columns, largest_count)};
}

}  // namespace

PathSweep::PathSweep(Direction direction, int columns, int largest_count, int small_step)
    : direction_(direction),
      columns_(columns),
      small_step_(small_step),
      before_(ThreeLines(columns, largest_count)),
      here_(ThreeLines(columns, largest_count)),
      along_(2, largest_count),
      zeros_(largest_count + 2 * DisparityWindow::kGrain, 0) {}

std::size_t PathSweep::BytesOf(int columns, int largest_count) {
  return 6 * PathLine::BytesOf(columns, largest_count) + PathLine::BytesOf(3, largest_count);
}

void PathSweep::Sweep(const RowLayout& layout, const std::uint8_t* costs, std::uint8_t* sums) {
  if (&layout != layout_two_before_) {
    for (PathLine& line : here_) line.Clear(layout);
  }
  RowSweep row;
  row.columns = columns_;
  row.step = direction_ == Direction::kDown ? 1 : -1;
  row.small_step = small_step_;
  row.layout = &layout;
  row.layout_before = layout_before_;
  row.costs = costs;
  row.sums = sums;
  row.before = &before_;
  row.here = &here_;
  row.along = &along_;
  row.zeros = zeros_.data() + 1;
  HWY_DYNAMIC_DISPATCH(SweepRow)(row);
  std::swap(before_, here_);
  layout_two_before_ = layout_before_;
  layout_before_ = &layout;
}

}  // namespace rigmap
#endif
