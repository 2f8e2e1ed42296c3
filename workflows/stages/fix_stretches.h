// Stretches of satellite fixes, by their stamps.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/stage.h"
#include "scene/dataset.h"

namespace rigmap {

// Fixes in turns of ten seconds, as far as these hold any: every other turn's tie poses, the others
// judge them.
struct SplitFixes {
  std::vector<GnssFix> tying, judging;
};
// Which turn a stamp is in.
std::int64_t TurnOf(StampNs stamp_ns);
SplitFixes SplitByTurns(std::vector<GnssFix> fixes);

// Of those that are RTK_FIXED, in their order.
std::vector<StampNs> StampsOfFixed(const std::vector<GnssFix>& fixes);

// Where there is none for more than two and a half usual steps, whoever has left them out: a list
// of first_ns, last_ns, the stamps on either side. Stamps are in order of time.
Report GapsBetween(const std::vector<StampNs>& stamps);

// Of fixes at these times, those one after the other that were not used: a list of first_ns,
// last_ns and count.
Report StretchesNotUsed(const std::vector<StampNs>& stamps, const std::vector<char>& used);

}  // namespace rigmap
