// summary.json: what an output folder holds, how it was made, and whether to trust it.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/ledger.h"
#include "workflows/part_request.h"
#include "workflows/reconstruct_part.h"

namespace rigmap {

// What the stages reported, put together: objects key by key, lists one behind the other; keys of
// what was not reached are null.
Report MergeReports(const Ledger& ledger);

// How far what the ledger speaks of is to be trusted. `first_frame`: the number of a part's first
// frame in the whole data set; of joined parts each numbers its own.
PartResult Judge(const Ledger& ledger, int first_frame = 0);

// summary.json as text, of a run of the recipe of that name. `failure` is what ended the run, if
// anything did.
std::string WriteSummary(const Ledger& ledger, const std::string& recipe,
                         const PartRequest& request, const std::string& failure);

}  // namespace rigmap
