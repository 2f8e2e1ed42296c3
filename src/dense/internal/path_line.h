// Aggregated costs of a row of pixels.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dense/internal/disparity_windows.h"

namespace rigmap {

// The aggregated costs of one path along a row of pixels, a slot per column with what counts as
// large to either side.
class PathLine {
 public:
  PathLine(int columns, int largest_count);

  std::uint8_t* Costs(int column) { return costs_.get() + column * stride_ + kBefore; }
  std::uint8_t& Least(int column) { return least_[column]; }
  // To be called before costs are written that have other windows than those written before.
  void Clear(const RowLayout& layout);

  static std::size_t BytesOf(int columns, int largest_count);

 private:
  // Reading starts at up to a vector and one before the window, and ends as far behind it. An odd
  // multiple of 16 keeps a small window and its neighbours within one cache line.
  static constexpr int kBefore = 80, kBehind = 80;
  static int StrideOf(int largest_count);

  std::size_t stride_ = 0;
  hwy::AlignedFreeUniquePtr<std::uint8_t[]> costs_;
  std::vector<std::uint8_t> least_;
  std::vector<int> cleared_;  // counts behind which all is large
};

}  // namespace rigmap
