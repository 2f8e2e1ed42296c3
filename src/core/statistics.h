// Order statistics.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace rigmap {

// 1.4826 times the median absolute deviation is the standard deviation of normal noise.
inline constexpr double kSigmaOfMedianDeviation = 1.4826;

// Of a sum of squares, each over its variance: rounding may take it below 0. What is not a number
// must not pass for agreement: it is infinite.
inline double RootOfSquares(double squares) {
  if (std::isnan(squares)) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(0.0, squares));
}

// The value that `share` (0 to 1) of the others come before, in the order of `key`. `values` must
// not be empty. Linear time.
template <class Value, class Key = std::identity>
Value Quantile(std::vector<Value> values, double share, const Key& key = {}) {
  const auto index = std::min(static_cast<std::size_t>(share * static_cast<double>(values.size())),
                              values.size() - 1);
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(index), {}, key);
  return values[index];
}

// Of an even number of values the upper of the two middle ones.
template <class Value>
Value Median(std::vector<Value> values) {
  return Quantile(std::move(values), 0.5);
}

template <class Value>
Value MedianAbsolute(std::vector<Value> values) {
  for (Value& value : values) value = std::abs(value);
  return Median(std::move(values));
}

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
