// One row of semi-global matching along four paths.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dense/internal/disparity_windows.h"
#include "dense/internal/path_line.h"

namespace rigmap {

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
