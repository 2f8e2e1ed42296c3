#include "dense/internal/winner.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense/winner.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef RIGMAP_DENSE_WINNER
#define RIGMAP_DENSE_WINNER
namespace rigmap {

// Of the right view, by column; before the first there are as many as disparities are searched.
struct RightColumns {
  std::uint16_t* least = nullptr;
  std::int16_t* disparity = nullptr;
};

}  // namespace rigmap
#endif

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

// A right pixel's disparity is that with the least sum of all left pixels that may match it.
HWY_INLINE void OfferToRight(const std::uint16_t* sums, const DisparityWindow& window,
                             const RightColumns& right) {
  const PathSums tag;
  const hn::RebindToSigned<PathSums> disparity_tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  for (int i = 0; i < window.count; i += lanes) {
    const int at = window.count - lanes - i;
    const auto sum = hn::Reverse(tag, hn::LoadU(tag, sums + i));
    const auto least = hn::LoadU(tag, right.least + at);
    const auto last =
        hn::Set(disparity_tag, static_cast<std::int16_t>(window.first + i + lanes - 1));
    const auto disparity = hn::Sub(last, hn::Iota(disparity_tag, 0));
    const auto before = hn::LoadU(disparity_tag, right.disparity + at);
    const auto is_less = hn::RebindMask(disparity_tag, hn::Lt(sum, least));
    hn::StoreU(hn::Min(sum, least), tag, right.least + at);
    hn::StoreU(hn::IfThenElse(is_less, disparity, before), disparity_tag, right.disparity + at);
  }
}

// `right`: of column 0. `limits`: by the least sum, what the others may not be below.
HWY_NOINLINE void FindWinners(const RowCosts& row, const std::uint16_t* limits, std::uint16_t* sums,
                              const RightColumns& right, std::span<WinnerRow::Winner> winners) {
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
    const DisparityWindow window{row.layout->first[column], count};
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(column) - window.End() + 1;
    OfferToRight(sums, window, {right.least + from, right.disparity + from});
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rigmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rigmap {
namespace {

HWY_EXPORT(FindWinners);

// The least of a parabola through three costs, from the middle one, in steps. Rounded to either
// side alike: cut off towards zero, half of all disparities would come out half a step too large.
int ParabolaSteps(const WinnerRow::Winner& winner) {
  const int bend = std::max(winner.before + winner.after - 2 * winner.least, 1);
  const int ahead = (winner.before - winner.after) * WinnerRow::kSteps;
  return (ahead + (ahead > 0 ? bend : -bend)) / (2 * bend);
}

}  // namespace

WinnerRow::WinnerRow(const TileWindows& windows, const DenseOptions& options)
    : limits_(kSums),
      left_right_px_(options.left_right_px),
      winners_(windows.size.width),
      sums_(windows.LargestCount()),
      right_least_(windows.size.width + windows.End()),
      right_disparity_(right_least_.size()) {
  const int share = std::max(1, 100 - options.uniqueness_pct);
  for (int least = 0; least < kSums; ++least) {
    limits_[least] = static_cast<std::uint16_t>(std::min((100 * least + share - 1) / share, 65535));
  }
}

void WinnerRow::Choose(const RowCosts& row, std::span<std::int16_t> disparities) {
  std::fill(right_least_.begin(), right_least_.end(), std::uint16_t{65535});
  const std::size_t first = right_least_.size() - winners_.size();
  HWY_DYNAMIC_DISPATCH(FindWinners)
  (row, limits_.data(), sums_.data(),
   {right_least_.data() + first, right_disparity_.data() + first}, winners_);
  for (int column = 0; column < static_cast<int>(winners_.size()); ++column) {
    const Winner& winner = winners_[column];
    const int disparity = row.layout->first[column] + winner.index;
    disparities[column] = kNoDisparity;
    // At the edge of its window it need not be a minimum.
    const bool inside = winner.index > 0 && winner.index + 1 < row.layout->count[column];
    if (!winner.unique || !inside || disparity > std::min(column, kMostDisparity)) continue;
    disparities[column] = static_cast<std::int16_t>(kSteps * disparity + ParabolaSteps(winner));
  }
  CompareViews(disparities);
}

// Seen from the right, a pixel must match about where it was matched from.
void WinnerRow::CompareViews(std::span<std::int16_t> disparities) const {
  const int columns = static_cast<int>(disparities.size());
  const std::int16_t* right = right_disparity_.data() + right_disparity_.size() - winners_.size();
  for (int column = 0; column < columns; ++column) {
    const int steps = disparities[column];
    if (steps == kNoDisparity) continue;
    const auto differs = [&](int disparity) {
      return disparity > column || std::abs(right[column - disparity] - disparity) > left_right_px_;
    };
    if (differs(steps / kSteps) && differs((steps + kSteps - 1) / kSteps)) {
      disparities[column] = kNoDisparity;
    }
  }
}

}  // namespace rigmap
#endif
