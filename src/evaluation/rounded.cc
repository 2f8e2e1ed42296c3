#include "evaluation/internal/rounded.h"

#include <array>
#include <charconv>

namespace rigmap {

double Rounded(double value, int decimals) {
  std::array<char, 400> text;  // the longest double has 309 digits before the point
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value,
                                     std::chars_format::fixed, decimals);
  double rounded = value;
  std::from_chars(text.data(), written.ptr, rounded);
  return rounded;
}

}  // namespace rigmap
