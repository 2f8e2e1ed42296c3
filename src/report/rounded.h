// Numbers for the scripts of a page, no longer than they need be.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "report/figures.h"
#include "scene/trajectory.h"

namespace rigmap {

// Five digits; 0 for what is not finite.
inline double Rounded5(double value) {
  return value == 0.0 || !std::isfinite(value) ? 0.0 : std::stod(fmt::format("{:.5g}", value));
}
// To a tenth of a millimetre.
inline double ToTenthOfMillimetre(double m) { return std::round(1e4 * m) / 1e4; }

// One of each pose.
template <class Get>
Json Values(const Trajectory& trajectory, const Get& get) {
  Json values = Json::array();
  for (std::size_t i = 0; i < trajectory.size(); ++i) values.push_back(get(trajectory[i]));
  return values;
}

}  // namespace rigmap
