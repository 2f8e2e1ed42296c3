#include "core/option_range.h"

#include <fmt/format.h>

#include <cmath>

namespace rigmap {

OptionRange OptionRange::UpTo(double limit) const {
  OptionRange range = *this;
  range.highest = limit;
  range.highest_excluded = false;
  return range;
}

OptionRange OptionRange::Below(double limit) const {
  OptionRange range = UpTo(limit);
  range.highest_excluded = true;
  return range;
}

OptionRange OptionRange::Odd() const {
  OptionRange range = *this;
  range.only_odd = true;
  return range;
}

bool OptionRange::Holds(double value) const {
  const bool high_enough = lowest_excluded ? value > lowest : value >= lowest;
  const bool low_enough = highest_excluded ? value < highest : value <= highest;
  return std::isfinite(value) && high_enough && low_enough &&
         (!only_odd || std::abs(std::fmod(value, 2.0)) == 1.0);
}

std::string OptionRange::Text() const {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  const bool limited_below = std::isfinite(lowest), limited_above = std::isfinite(highest);
  if (limited_below && limited_above && !lowest_excluded && !highest_excluded) {
    add(fmt::format("{} to {}", lowest, highest));
  } else {
    if (limited_below) {
      add(fmt::format("{} {}", lowest_excluded ? "more than" : "at least", lowest));
    }
    if (limited_above) {
      add(fmt::format("{} {}", highest_excluded ? "less than" : "at most", highest));
    }
  }
  if (only_odd) add("odd");
  return text.empty() ? "any number" : text;
}

OptionRange AtLeast(double limit) {
  OptionRange range;
  range.lowest = limit;
  return range;
}

OptionRange MoreThan(double limit) {
  OptionRange range = AtLeast(limit);
  range.lowest_excluded = true;
  return range;
}

}  // namespace rigmap
