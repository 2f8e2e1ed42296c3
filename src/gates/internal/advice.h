// What more than one cause advises. Of this room only.
#pragma once

#include <string>
#include <string_view>

#include "gates/internal/failed.h"

namespace rigmap {

inline constexpr std::string_view kManyDrives =
    "run other drives of the same rig, with curves; rigmap calibrate FOLDER FOLDER ... --rig-out "
    "rig.yaml makes one calibration of all their results; then run this one again with --rig "
    "rig.yaml";

// Against a gap that nothing measured bridges.
std::string AdviceOnGaps(const Failed& failed);

}  // namespace rigmap
