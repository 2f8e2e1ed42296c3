#include "core/stamp_steps.h"

#include "core/statistics.h"

namespace rigmap {

StampSteps StepsOf(const std::vector<StampNs>& stamps) {
  std::vector<StampNs> steps_ns;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps_ns.push_back(stamps[i] - stamps[i - 1]);
  StampSteps result;
  if (steps_ns.empty()) return result;
  result.usual_ns = Median(steps_ns);
  const double limit_ns = kGapSteps * static_cast<double>(result.usual_ns);
  for (std::size_t i = 0; i < steps_ns.size(); ++i) {
    if (static_cast<double>(steps_ns[i]) > limit_ns) result.gaps.push_back(i);
  }
  return result;
}

}  // namespace rigmap
