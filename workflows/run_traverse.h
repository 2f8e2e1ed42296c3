// `rigmap run`: a traverse's parts, as many at the same time as threads and memory allow, joined
// into one world.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "workflows/part_request.h"
#include "workflows/reconstruct_part.h"
#include "workflows/traverse_plan.h"

namespace rigmap {

struct RunRequest {
  PlanRequest plan;
  bool use_rtk = false;  // JoinRequest::use_rtk
  // How each part is done; its dataset, out, truth, until and from are those of the whole.
  PartRequest part;
  std::optional<std::string> part_until, part_from;  // stages of a part
};

// Leaves each part in part.out/parts/<name>, the plan in part.out/plan.json and the whole, as
// JoinParts does, in part.out. A part that fails, whatever it throws, is named, and the others are
// joined without it; the result is then not trusted. Where part_until ends before what a join needs
// there are the parts alone. Throws UsageError and DataError as PlanTraverse and JoinParts, before
// any part is done where use_rtk has no fixes or antenna, and one of them where no part can be
// done.
PartResult RunTraverse(const RunRequest& request);

}  // namespace rigmap
