#include "workflows/stages/fix_stretches.h"

#include "core/statistics.h"

namespace rigmap {

std::vector<StampNs> StampsOfFixed(const std::vector<GnssFix>& fixes) {
  std::vector<StampNs> stamps;
  for (const GnssFix& fix : fixes) {
    if (fix.status == kRtkFixed) stamps.push_back(fix.stamp_ns);
  }
  return stamps;
}

Report GapsBetween(const std::vector<StampNs>& stamps) {
  Report gaps = Report::array();
  std::vector<StampNs> steps_ns;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps_ns.push_back(stamps[i] - stamps[i - 1]);
  if (steps_ns.empty()) return gaps;
  constexpr double kGapSteps = 2.5;
  const auto limit_ns = static_cast<StampNs>(kGapSteps * static_cast<double>(Median(steps_ns)));
  for (std::size_t i = 0; i < steps_ns.size(); ++i) {
    if (steps_ns[i] > limit_ns) {
      gaps.push_back({{"first_ns", stamps[i]}, {"last_ns", stamps[i + 1]}});
    }
  }
  return gaps;
}

Report StretchesNotUsed(const std::vector<StampNs>& stamps, const std::vector<char>& used) {
  Report stretches = Report::array();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (used[i]) continue;
    if (i == 0 || used[i - 1]) {
      stretches.push_back({{"first_ns", stamps[i]}, {"last_ns", stamps[i]}, {"count", 0}});
    }
    stretches.back()["last_ns"] = stamps[i];
    stretches.back()["count"] = stretches.back()["count"].get<int>() + 1;
  }
  return stretches;
}

}  // namespace rigmap
