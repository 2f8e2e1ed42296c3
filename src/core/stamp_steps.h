// Gaps in series of stamps.
#pragma once

#include <cstddef>
#include <vector>

#include "core/stamp.h"

namespace rigmap {

struct StampSteps {
  StampNs usual_ns = 0;           // median; 0 of fewer than two stamps
  std::vector<std::size_t> gaps;  // those i for which i to i + 1 is more than 2.5 usual steps
};

// Of stamps in order of time. The next stamp may be late, but not by two.
StampSteps StepsOf(const std::vector<StampNs>& stamps);

}  // namespace rigmap
