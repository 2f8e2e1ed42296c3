// What a user asks of a recipe.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rigmap {

struct RunPlan {
  std::string recipe;                      // its name, for the ledger
  std::optional<std::string> until, from;  // stage names of the graph
  int memory_mb = 2048;
  // What any recipe may publish: of these nothing may lie in the folder that no record speaks of.
  std::vector<std::string> known_outputs;
  // Whether a stage that is made anew may take up what an earlier run has found of single frames.
  bool take_up_frames = true;
};

}  // namespace rigmap
