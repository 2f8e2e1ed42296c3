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

// A PathLine's slots as the kernel walks along them.
struct Slots {
  std::uint8_t* costs = nullptr;  // of the first slot
  std::uint8_t* least = nullptr;
  std::ptrdiff_t stride = 0;

  Slots() = default;
  explicit Slots(PathLine& line)
      : costs(line.Costs(0)), least(&line.Least(0)), stride(line.Costs(1) - line.Costs(0)) {}
};

// Aggregated costs at the pixel before on a path: where its window begins, and their least.
struct PathEnd {
  const std::uint8_t* costs = nullptr;
  const std::uint8_t* least = nullptr;
  int first = 0, count = 0;
};

struct RowSweep {
  int columns = 0;
  int step = 1;  // from column to column
  int small_step = 0;
  const RowLayout *layout = nullptr, *layout_before = nullptr;
  const std::uint8_t* costs = nullptr;
  std::uint8_t* sums = nullptr;
  Slots along;                        // of the pixel before and this one
  std::array<Slots, 3> before, here;  // of paths that come from the row before
  const std::uint8_t* zeros = nullptr;

  PathEnd EndIn(const Slots& slots, const RowLayout& there, int slot, int column) const {
    return {slots.costs + slot * slots.stride, slots.least + slot, there.first[column],
            there.count[column]};
  }
  PathEnd OutsideOf(int column) const {
    return {zeros, zeros, layout->first[column], layout->count[column]};
  }
  bool HasColumn(int column) const { return column >= 0 && column < columns; }

  // Where pixels before have the same windows, those need not be known.
  template <bool kSameWindow>
  PathEnd Along(int column) const {
    const int from = column - step, slot = from & 1;
    if (kSameWindow) return {along.costs + slot * along.stride, along.least + slot};
    return HasColumn(from) ? EndIn(along, *layout, from & 1, from) : OutsideOf(column);
  }
  template <bool kSameWindow>
  PathEnd Across(int path, int column) const {
    const int from = column + (path - 1) * step;
    const Slots& slots = before[path];
    if (kSameWindow) return {slots.costs + from * slots.stride, slots.least + from};
    const bool is_there = layout_before != nullptr && HasColumn(from);
    return is_there ? EndIn(slots, *layout_before, from, from) : OutsideOf(column);
  }
  // Whether the pixels before it on all paths have its window.
  bool IsWithinTile(int column) const {
    constexpr int kLast = TileWindows::kTilePx - 1;
    const int in_tile = column & kLast;
    return layout == layout_before && in_tile > 0 && in_tile < kLast && column + 1 < columns;
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
constexpr bool kCanCarry = hn::MaxLanes(Costs()) == DisparityWindow::kGrain;

// By way of pairs as 16 bit, for which there is an instruction.
template <class Tag>
HWY_INLINE std::uint8_t LeastOf([[maybe_unused]] Tag tag, hn::Vec<Tag> costs) {
#if HWY_TARGET == HWY_SCALAR
  return hn::GetLane(costs);
#else
  if constexpr (hn::MaxLanes(tag) > 16) {
    const hn::Half<Tag> half;
    return LeastOf(half, hn::Min(hn::LowerHalf(half, costs), hn::UpperHalf(half, costs)));
  } else {
    const hn::Repartition<std::uint16_t, Tag> pairs;
    const auto high = hn::BitCast(tag, hn::ShiftRight<8>(hn::BitCast(pairs, costs)));
    // The upper byte of each pair becomes 0.
    const auto least = hn::BitCast(pairs, hn::Min(costs, high));
    return static_cast<std::uint8_t>(hn::GetLane(hn::MinOfLanes(pairs, least)));
  }
#endif
}

struct Steps {
  CostVector small_step, large_step;
};

// m(p, d) for a vector of disparities that begin `ahead` of the first of q's window.
template <bool kSameWindow>
HWY_INLINE CostVector StepFrom(const PathEnd& before, int ahead, const Steps& steps) {
  const Costs tag;
  // Beyond these all is large.
  if constexpr (!kSameWindow) {
    ahead = std::clamp(ahead, -DisparityWindow::kGrain - 1, before.count + 1);
  }
  const std::uint8_t* costs = before.costs + ahead;
  const auto least = hn::Set(tag, *before.least);
  const auto stepped = hn::SaturatedAdd(
      hn::Min(hn::LoadU(tag, costs - 1), hn::LoadU(tag, costs + 1)), steps.small_step);
  const auto large = hn::SaturatedAdd(least, steps.large_step);
  return hn::Sub(hn::Min(hn::Min(hn::LoadU(tag, costs), stepped), large), least);
}

// What the pixel before on the row leaves in registers: to read it back from memory, one disparity
// off, takes longer than all else.
struct Carried {
  CostVector costs;
  std::uint8_t least = 0;
};

enum class Window {
  kAny,
  kSame,        // at all pixels before
  kSameVector,  // and as long as a vector
};

// Disparity d receives the cost of d - 1, or of d + 1; the last one a large cost.
template <class Tag>
HWY_INLINE hn::Vec<Tag> LeastBeside([[maybe_unused]] Tag tag, hn::Vec<Tag> costs) {
#if HWY_TARGET == HWY_SCALAR
  return costs;  // never called
#else
  const auto large = hn::Set(tag, 255);
  const auto below =
      hn::CombineShiftRightBytes<15>(tag, costs, hn::ConcatLowerLower(tag, costs, large));
  const auto above =
      hn::CombineShiftRightBytes<1>(tag, hn::ConcatUpperUpper(tag, large, costs), costs);
  return hn::Min(below, above);
#endif
}

template <class Tag>
HWY_INLINE hn::Vec<Tag> StepFromCarried(Tag tag, const Carried& carried, const Steps& steps) {
  const auto least = hn::Set(tag, carried.least);
  const auto stepped = hn::SaturatedAdd(LeastBeside(tag, carried.costs), steps.small_step);
  const auto large = hn::SaturatedAdd(least, steps.large_step);
  return hn::Sub(hn::Min(hn::Min(carried.costs, stepped), large), least);
}

template <Window kWindow>
HWY_INLINE void SweepPixel(const RowSweep& row, int column, const Steps& steps, Carried& carried) {
  constexpr bool kSameWindow = kWindow != Window::kAny;
  const Costs tag;
  const int first = row.layout->first[column], count = row.layout->count[column];
  const std::size_t offset = row.layout->offset[column];
  const PathEnd end0 = row.Along<kSameWindow>(column), end1 = row.Across<kSameWindow>(0, column),
                end2 = row.Across<kSameWindow>(1, column),
                end3 = row.Across<kSameWindow>(2, column);
  std::uint8_t* const here0 = row.along.costs + (column & 1) * row.along.stride;
  const std::ptrdiff_t slot = column * row.here[0].stride;
  std::uint8_t *const here1 = row.here[0].costs + slot, *const here2 = row.here[1].costs + slot,
                      *const here3 = row.here[2].costs + slot;
  auto least0 = hn::Set(tag, 255), least1 = least0, least2 = least0, least3 = least0;
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
    const auto cost = hn::LoadU(tag, row.costs + offset + i);
    const auto step_from = [&](const PathEnd& end) HWY_ATTR {
      const int ahead = kSameWindow ? i : first - end.first + i;
      return StepFrom<kSameWindow>(end, ahead, steps);
    };
    const auto aggregate = [&](CostVector step, std::uint8_t* here, CostVector& least) HWY_ATTR {
      const auto aggregated = hn::Add(cost, step);
      least = hn::Min(least, aggregated);
      hn::StoreU(aggregated, tag, here + i);
    };
    CostVector step0;
    if constexpr (kWindow == Window::kSameVector) {
      step0 = StepFromCarried(tag, carried, steps);
    } else {
      step0 = step_from(end0);
    }
    const auto step1 = step_from(end1), step2 = step_from(end2), step3 = step_from(end3);
    aggregate(step0, here0, least0);
    aggregate(step1, here1, least1);
    aggregate(step2, here2, least2);
    aggregate(step3, here3, least3);
    hn::StoreU(hn::Add(hn::Add(step0, step1), hn::Add(step2, step3)), tag, row.sums + offset + i);
  }
  carried = {least0, LeastOf(tag, least0)};  // the costs, where there was one vector of them
  row.along.least[column & 1] = carried.least;
  row.here[0].least[column] = LeastOf(tag, least1);
  row.here[1].least[column] = LeastOf(tag, least2);
  row.here[2].least[column] = LeastOf(tag, least3);
  // The slots along the row change their windows from tile to tile.
  for (int i = 0; i < 2 * DisparityWindow::kGrain; i += static_cast<int>(hn::Lanes(tag))) {
    hn::StoreU(hn::Set(tag, 255), tag, here0 + count + i);
  }
}

HWY_NOINLINE void SweepRow(const RowSweep& row) {
  const Costs tag;
  const Steps steps{hn::Set(tag, static_cast<std::uint8_t>(row.small_step)),
                    hn::Set(tag, static_cast<std::uint8_t>(CostScale::kLargeStep))};
  Carried carried{hn::Zero(tag)};
  for (int i = 0; i < row.columns; ++i) {
    const int column = row.step > 0 ? i : row.columns - 1 - i;
    if (!row.IsWithinTile(column)) {
      SweepPixel<Window::kAny>(row, column, steps, carried);
    } else if (kCanCarry && row.layout->count[column] == DisparityWindow::kGrain) {
      SweepPixel<kCanCarry ? Window::kSameVector : Window::kSame>(row, column, steps, carried);
    } else {
      SweepPixel<Window::kSame>(row, column, steps, carried);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {

HWY_EXPORT(SweepRow);

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
  row.along = Slots(along_);
  for (int i = 0; i < 3; ++i) {
    row.before[i] = Slots(before_[i]);
    row.here[i] = Slots(here_[i]);
  }
  row.zeros = zeros_.data() + 1;
  HWY_DYNAMIC_DISPATCH(SweepRow)(row);
  std::swap(before_, here_);
  layout_two_before_ = layout_before_;
  layout_before_ = &layout;
}

}  // namespace rigmap
#endif
