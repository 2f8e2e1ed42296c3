// What a run has to do, decided before it does anything.
#pragma once

#include <any>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/ledger.h"
#include "pipeline/run_plan.h"
#include "pipeline/stage_graph.h"

namespace rigmap {

// For each node of a graph.
struct Schedule {
  std::vector<bool> selected;  // this run needs it, or asks it: a check, once its inputs are there
  std::vector<bool> anew;      // selected, and to be made again whatever is kept
  // Of its code, its options and the keys of what it takes. Nothing where that depends on a source
  // that nobody asked for, now or before.
  std::vector<std::optional<std::string>> keys;
  std::vector<std::any> sources;  // the values of the selected sources, else empty
};

// Opens the selected sources; throws what they throw, and std::logic_error if the plan names what
// is not in the graph.
Schedule MakeSchedule(const StageGraph& graph, const RunPlan& plan, const Ledger& ledger);

// What does not hold any more: it was made from other inputs, options or code, or is asked for
// anew.
struct Outdated {
  std::vector<std::string> stages;   // of the ledger
  std::vector<std::string> outputs;  // of the plan's known ones, as they lie in `root`
};
Outdated FindOutdated(const StageGraph& graph, const Schedule& schedule, const Ledger& ledger,
                      const std::vector<std::string>& known_outputs,
                      const std::filesystem::path& root);

}  // namespace rigmap
