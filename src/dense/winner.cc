#include "dense/internal/winner.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/winner.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rigmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PathSums = hn::CappedTag<std::uint16_t, DisparityWindow::kGrain / 2>;
using PathBytes = hn::Half<hn::Repartition<std::uint8_t, PathSums>>;

template <class Tag>
HWY_INLINE std::uint16_t LeastSum([[maybe_unused]] Tag tag, hn::Vec<Tag> sums) {
#if HWY_TARGET == HWY_SCALAR
  return hn::GetLane(sums);
#else
  if constexpr (hn::MaxLanes(tag) > 8) {
    const hn::Half<Tag> half;
    return LeastSum(half, hn::Min(hn::LowerHalf(half, sums), hn::UpperHalf(half, sums)));
  } else {
    return hn::GetLane(hn::MinOfLanes(tag, sums));
  }
#endif
}

// S = 8 C + all m, and its least.
HWY_INLINE std::uint16_t SumPaths(const RowCosts& row, std::size_t offset, int count,
                                  std::uint16_t* sums) {
  const PathSums tag;
  const PathBytes bytes;
  auto least = hn::Set(tag, std::numeric_limits<std::uint16_t>::max());
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
    const auto load = [&](const std::uint8_t* of) HWY_ATTR {
      return hn::PromoteTo(tag, hn::LoadU(bytes, of + offset + i));
    };
    const auto sum = hn::Add(hn::ShiftLeft<3>(load(row.costs)),
                             hn::Add(load(row.sums_above), load(row.sums_below)));
    hn::StoreU(sum, tag, sums + i);
    least = hn::Min(least, sum);
  }
  return LeastSum(tag, least);
}

HWY_INLINE int FirstEqual(const std::uint16_t* sums, std::uint16_t value) {
  const PathSums tag;
  const auto wanted = hn::Set(tag, value);
  for (int i = 0;; i += static_cast<int>(hn::Lanes(tag))) {
    const auto found = hn::FindFirstTrue(tag, hn::Eq(hn::LoadU(tag, sums + i), wanted));
    if (found >= 0) return i + static_cast<int>(found);
  }
}

HWY_INLINE int CountBelow(const std::uint16_t* sums, int count, std::uint16_t limit) {
  const PathSums tag;
  const auto below = hn::Set(tag, limit);
  std::size_t found = 0;
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
    found += hn::CountTrue(tag, hn::Lt(hn::LoadU(tag, sums + i), below));
  }
  return static_cast<int>(found);
}

// `limits`: by the least sum, what the others may not be below.
HWY_NOINLINE void FindWinners(const RowCosts& row, const std::uint16_t* limits, std::uint16_t* sums,
                              std::span<WinnerRow::Winner> winners) {
  for (std::size_t column = 0; column < winners.size(); ++column) {
    const int count = row.layout->count[column];
    const std::uint16_t least = SumPaths(row, row.layout->offset[column], count, sums);
    const std::uint16_t limit = limits[least];
    WinnerRow::Winner& winner = winners[column];
    winner.index = FirstEqual(sums, least);
    winner.least = least;
    const bool has_before = winner.index > 0, has_after = winner.index + 1 < count;
    winner.before = sums[winner.index - has_before];
    winner.after = sums[winner.index + has_after];
    const int near = (least < limit) + (has_before & (winner.before < limit)) +
                     (has_after & (winner.after < limit));
    winner.unique = CountBelow(sums, count, limit) == near;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {
namespace {

HWY_EXPORT(FindWinners);

// The least of a parabola through three costs, from the middle one, in steps.
int ParabolaSteps(const WinnerRow::Winner& winner) {
  const int bend = std::max(winner.before + winner.after - 2 * winner.least, 1);
  return ((winner.before - winner.after) * WinnerRow::kSteps + bend) / (2 * bend);
}

}  // namespace

WinnerRow::WinnerRow(int columns, int largest_count, const DenseOptions& options)
    : limits_(kSums),
      left_right_px_(options.left_right_px),
      winners_(columns),
      sums_(largest_count),
      right_least_(columns),
      right_disparity_(columns) {
  const int share = std::max(1, 100 - options.uniqueness_pct);
  for (int least = 0; least < kSums; ++least) {
    limits_[least] = static_cast<std::uint16_t>(std::min((100 * least + share - 1) / share, 65535));
  }
}

void WinnerRow::Choose(const RowCosts& row, std::span<std::int16_t> disparities) {
  HWY_DYNAMIC_DISPATCH(FindWinners)(row, limits_.data(), sums_.data(), winners_);
  std::fill(right_least_.begin(), right_least_.end(), std::uint16_t{65535});
  std::fill(right_disparity_.begin(), right_disparity_.end(), kNoDisparity);
  for (int column = 0; column < static_cast<int>(winners_.size()); ++column) {
    const Winner& winner = winners_[column];
    const int disparity = row.layout->first[column] + winner.index;
    disparities[column] = kNoDisparity;
    // At the edge of its window it need not be a minimum.
    const bool inside = winner.index > 0 && winner.index + 1 < row.layout->count[column];
    if (!winner.unique || !inside || disparity > column) continue;
    disparities[column] = static_cast<std::int16_t>(kSteps * disparity + ParabolaSteps(winner));
    const int right = column - disparity;
    if (winner.least < right_least_[right]) {
      right_least_[right] = static_cast<std::uint16_t>(winner.least);
      right_disparity_[right] = static_cast<std::int16_t>(disparity);
    }
  }
  CompareViews(disparities);
}

// A pixel of the right view is matched by several of the left one: all but that with the least sum
// are wrong, unless they agree.
void WinnerRow::CompareViews(std::span<std::int16_t> disparities) const {
  const int columns = static_cast<int>(disparities.size());
  for (int column = 0; column < columns; ++column) {
    const int steps = disparities[column];
    if (steps == kNoDisparity) continue;
    const auto differs = [&](int disparity) {
      const int right = column - disparity;
      return right >= 0 && right < columns && right_disparity_[right] != kNoDisparity &&
             std::abs(right_disparity_[right] - disparity) > left_right_px_;
    };
    if (differs(steps / kSteps) && differs((steps + kSteps - 1) / kSteps)) {
      disparities[column] = kNoDisparity;
    }
  }
}

}  // namespace rigmap
#endif
