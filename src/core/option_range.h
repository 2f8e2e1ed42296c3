// Which numbers an option may be.
#pragma once

#include <limits>
#include <string>

namespace rigmap {

struct OptionRange {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_excluded = false, highest_excluded = false;
  bool only_odd = false;  // of whole numbers

  OptionRange UpTo(double limit) const;
  OptionRange Below(double limit) const;
  OptionRange Odd() const;

  bool Holds(double value) const;
  // "0 to 1"; "more than 0, at most 180"; "at least 5, odd"; "any number".
  std::string Text() const;
};

OptionRange AtLeast(double limit);
OptionRange MoreThan(double limit);

}  // namespace rigmap
