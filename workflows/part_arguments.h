// The arguments of the commands that reconstruct a part.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "workflows/join.h"
#include "workflows/part_request.h"
#include "workflows/run_traverse.h"

namespace rigmap {

// As typed.
struct PartArguments {
  std::string dataset, out, rig, config, frames, format, until, from, truth;
  std::string technique = "rig";
  std::optional<int> traverse, part, threads;
  std::optional<double> accuracy_pct;
  int memory_mb = 2048;
  std::vector<std::string> assignments;
  bool force = false, quiet = false, depth_maps = false;
};

// What a part is made from and how good it has to be: of all commands that reconstruct one. Returns
// --dataset.
CLI::Option* AddPartInputs(CLI::App* command, PartArguments& arguments);

// The subcommand `part`.
void AddPart(CLI::App& app, PartArguments& arguments);
// Throws UsageError and DataError for what cannot be; opens nothing but the options' file.
PartRequest MakeRequest(const PartArguments& arguments, std::string command);

struct RunArguments {
  PartArguments part;
  std::optional<int> split, max_frames;
  int overlap = PlanRequest().overlap;
  bool sbatch = false;   // of `plan`
  bool use_rtk = false;  // of `run`
};

// The subcommands `run` and `plan`.
CLI::App* AddRun(CLI::App& app, RunArguments& arguments);
CLI::App* AddPlan(CLI::App& app, RunArguments& arguments);
// As MakeRequest.
RunRequest MakeRunRequest(const RunArguments& arguments, std::string command);
// The plan as JSON or, if wanted, as a script for sbatch.
std::string PrintPlan(const RunArguments& arguments);

struct JoinArguments {
  PartArguments whole;
  std::vector<std::string> outs, missing;
  bool use_rtk = false;
};

// The subcommand `join`.
CLI::App* AddJoin(CLI::App& app, JoinArguments& arguments);
// As MakeRequest. Without --config the first part's options apply.
JoinRequest MakeJoinRequest(const JoinArguments& arguments, std::string command);

template <class Value>
std::optional<Value> IfGiven(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional<Value>(text);
}

}  // namespace rigmap
