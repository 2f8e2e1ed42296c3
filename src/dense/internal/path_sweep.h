// One row of semi-global matching along four paths.
#pragma once

#include <hwy/aligned_allocator.h>

#include <array>
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
};

// Sweeps over an image row by row, downwards with columns ascending or upwards with columns
// descending, along the four paths that come from pixels swept before (Hirschmueller 2008, eq. 13):
//   L(p, d) = C(p, d) + m(p, d)
//   m(p, d) = min(L(q, d), L(q, d - 1) + small, L(q, d + 1) + small, min L(q) + large) - min L(q)
// with q the pixel before p. Costs are bytes: disparities outside of q's window cost 255, and so
// does whatever would cost more. At the edge of the image, m is 0.
class PathSweep {
 public:
  enum class Direction { kDown, kUp };

  PathSweep(Direction direction, int columns, int largest_count, int small_step);

  // The next row. Writes the sum of m over the four paths for each cost; both rows lie as `layout`
  // says, which must live until the next row is swept.
  void Sweep(const RowLayout& layout, const std::uint8_t* costs, std::uint8_t* sums);

  static std::size_t BytesOf(int columns, int largest_count);

 private:
  using RowLines = std::array<PathLine, 3>;  // from the row before: diagonal, straight, diagonal

  Direction direction_;
  int columns_ = 0, small_step_ = 0;
  RowLines before_, here_;
  const RowLayout *layout_before_ = nullptr, *layout_two_before_ = nullptr;
  PathLine along_;  // two slots: the pixel before and this one
  std::vector<std::uint8_t> zeros_;
};

}  // namespace rigmap
