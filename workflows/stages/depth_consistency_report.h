// What summary.json says of stereo against temporal depth.
#pragma once

#include <optional>

#include "gates/depth_consistency.h"
#include "pipeline/ledger.h"

namespace rigmap {

// Null for nothing.
Report ReportDepthConsistency(const std::optional<DepthConsistency>& consistency);

}  // namespace rigmap
