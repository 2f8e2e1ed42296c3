// The method: from the stereo frames of a part to a metric trajectory and map.
#pragma once

#include <string>

#include "workflows/part_request.h"

namespace rigmap {

struct PartResult {
  PartStatus status = PartStatus::kTrusted;
  std::string reason;  // why it is not to be trusted
};

// Writes everything of the contract into request.out. Throws Error when a part cannot be done;
// summary.json then says so too, if the folder could be claimed.
PartResult ReconstructPart(const PartRequest& request);

}  // namespace rigmap
