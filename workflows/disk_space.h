// Whether a traverse fits on the disk.
#pragma once

#include <filesystem>

#include "workflows/traverse_plan.h"

namespace rigmap {

// Throws DataError, one sentence, where the disk of `out` has less room than the plan's parts and
// their whole are estimated to need beside what lies in `out` already, which need not be there.
void RequireDisk(const TraversePlan& plan, const std::filesystem::path& out);

}  // namespace rigmap
