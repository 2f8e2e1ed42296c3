#include "workflows/stages/fix_stretches.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/stamp_steps.h"

namespace rigmap {

std::int64_t TurnOf(StampNs stamp_ns) {
  constexpr StampNs kTurn_ns = 10'000'000'000;
  return stamp_ns / kTurn_ns;
}

SplitFixes SplitByTurns(std::vector<GnssFix> fixes) {
  std::ranges::stable_sort(fixes, {}, &GnssFix::stamp_ns);
  SplitFixes split;
  bool ties = false;
  std::optional<std::int64_t> last_turn;
  for (GnssFix& fix : fixes) {
    const std::int64_t turn = TurnOf(fix.stamp_ns);
    // Turns without a fix do not count: one a minute would be all of one kind.
    if (turn != last_turn) ties = last_turn ? !ties : turn % 2 == 0;
    last_turn = turn;
    (ties ? split.tying : split.judging).push_back(std::move(fix));
  }
  return split;
}

std::vector<StampNs> StampsOfFixed(const std::vector<GnssFix>& fixes) {
  std::vector<StampNs> stamps;
  for (const GnssFix& fix : fixes) {
    if (fix.status == kRtkFixed) stamps.push_back(fix.stamp_ns);
  }
  return stamps;
}

Report GapsBetween(const std::vector<StampNs>& stamps) {
  Report gaps = Report::array();
  for (const std::size_t i : StepsOf(stamps).gaps) {
    gaps.push_back({{"first_ns", stamps[i]}, {"last_ns", stamps[i + 1]}});
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
