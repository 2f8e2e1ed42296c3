// An option with another value than it has.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/options.h"

namespace rigmap {

// Gives the field another value that its range allows: the nearest of a few, so that what limits
// one option by another mostly still holds.
inline void ChangeOption(const OptionField& field) {
  const auto nearest = [&](double value, std::vector<double> others) {
    const auto it = std::find_if(others.begin(), others.end(), [&](double other) {
      return other != value && field.range.Holds(other);
    });
    return it == others.end() ? value : *it;
  };
  if (const auto* on = std::get_if<bool*>(&field.value)) **on = !**on;
  if (const auto* whole = std::get_if<int*>(&field.value)) {
    const double value = **whole;
    **whole = static_cast<int>(nearest(value, {value + 1, value + 2, value - 1, value - 2}));
  }
  if (const auto* real = std::get_if<double*>(&field.value)) {
    const double value = **real;
    **real = nearest(value, {0.93 * value + 1e-3 / 3.0, 1.07 * value + 1e-3 / 3.0});
  }
  if (const auto* choice = std::get_if<OptionChoice>(&field.value)) {
    choice->choose((choice->index() + 1) % choice->names.size());
  }
}

}  // namespace rigmap
