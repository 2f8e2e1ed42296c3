// The stages of a technique as the table that docs/stages.md shows.
#pragma once

#include <string>

#include "pipeline/stage_graph.h"

namespace rigmap {

// Markdown: a row for each stage and check, in order, with what it takes, reads, makes and
// publishes. A view is shown as what it was made from.
std::string PrintStages(const StageGraph& recipe);

}  // namespace rigmap
