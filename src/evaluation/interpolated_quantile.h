// Quantiles that lie between two values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rigmap {

// Linear between the two order statistics around share * (n - 1), as numpy's default (Hyndman and
// Fan 1996, type 7). `values` must not be empty; it is reordered. Linear time.
inline double InterpolatedQuantile(std::vector<double>& values, double share) {
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto lower = values.begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(values.begin(), lower, values.end());
  if (lower + 1 == values.end()) return *lower;
  const double upper = *std::min_element(lower + 1, values.end());
  return *lower + (upper - *lower) * (rank - std::floor(rank));
}

}  // namespace rigmap
