// Which disparity wins at each pixel of a row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dense/dense_options.h"
#include "dense/internal/disparity_windows.h"

namespace rigmap {

// What paths found along a row of pixels, as its layout says.
struct RowCosts {
  const RowLayout* layout = nullptr;
  const std::uint8_t* costs = nullptr;       // of matching
  const std::uint8_t* sums_above = nullptr;  // of steps, four paths each
  const std::uint8_t* sums_below = nullptr;
};

// The disparity with the least sum of eight aggregated costs, in steps of 1/16 px; kNoDisparity
// where that is not sure.
class WinnerRow {
 public:
  static constexpr int kSteps = 16;
  static constexpr std::int16_t kNoDisparity = -kSteps;
  static constexpr int kMostDisparity = 2046;  // px; beyond there are more steps than 16 bit hold
  static constexpr std::size_t kBytesPerColumn = 32;  // that it takes

  WinnerRow(const TileWindows& windows, const DenseOptions& options);

  void Choose(const RowCosts& row, std::span<std::int16_t> disparities);

  // The least sum of a pixel, and those of one disparity less and more.
  struct Winner {
    int index = 0;  // in the window
    int least = 0, before = 0, after = 0;
    bool unique = false;  // no other sum is nearly as low
  };

 private:
  void CompareViews(std::span<std::int16_t> disparities) const;

  static constexpr int kSums = 8 * 256;  // of eight aggregated costs of a byte

  std::vector<std::uint16_t> limits_;  // by the least sum, what others may not be below
  int left_right_px_ = 0;
  std::vector<Winner> winners_;
  std::vector<std::uint16_t> sums_;  // of one pixel
  // By column of the right view; before the first as many as disparities are searched.
  std::vector<std::uint16_t> right_least_;
  std::vector<std::int16_t> right_disparity_;  // px
};

}  // namespace rigmap
