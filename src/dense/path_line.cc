#include "dense/internal/path_line.h"

#include <algorithm>

namespace rigmap {

int PathLine::StrideOf(int largest_count) {
  return (kBefore + largest_count + kBehind + 63) / 64 * 64;
}

std::size_t PathLine::BytesOf(int columns, int largest_count) {
  return static_cast<std::size_t>(columns) * (StrideOf(largest_count) + 1 + sizeof(int));
}

PathLine::PathLine(int columns, int largest_count)
    : stride_(StrideOf(largest_count)),
      costs_(hwy::AllocateAligned<std::uint8_t>(columns * stride_)),
      least_(columns),
      cleared_(columns) {
  std::fill_n(costs_.get(), columns * stride_, std::uint8_t{255});
}

void PathLine::Clear(const RowLayout& layout) {
  for (std::size_t column = 0; column < least_.size(); ++column) {
    if (cleared_[column] == layout.count[column]) continue;
    cleared_[column] = layout.count[column];
    std::fill_n(Costs(static_cast<int>(column)) + cleared_[column], kBehind, std::uint8_t{255});
  }
}

}  // namespace rigmap
