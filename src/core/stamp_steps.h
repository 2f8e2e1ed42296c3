// Gaps in series of stamps.
#pragma once

#include <cstddef>
#include <vector>

#include "core/stamp.h"

namespace rigmap {

inline double SecondsBetween(StampNs from_ns, StampNs to_ns) {
  return 1e-9 * static_cast<double>(to_ns - from_ns);
}

// The next stamp may be late, but not by two.
inline constexpr double kGapSteps = 2.5;  // usual ones

struct StampSteps {
  StampNs usual_ns = 0;           // median; 0 of fewer than two stamps
  std::vector<std::size_t> gaps;  // those i for which i to i + 1 is more than kGapSteps usual steps
};

// Of stamps in order of time.
StampSteps StepsOf(const std::vector<StampNs>& stamps);

}  // namespace rigmap
