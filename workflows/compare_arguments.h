// The arguments of the command `compare`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "workflows/compare.h"
#include "workflows/part_arguments.h"

namespace rigmap {

struct CompareArguments {
  PartArguments part;
  std::vector<std::string> outs, techniques, sweeps;
  int repeats = 1;
};

// The subcommand `compare`.
CLI::App* AddCompare(CLI::App& app, CompareArguments& arguments);
// As MakeRequest.
CompareRequest MakeCompareRequest(const CompareArguments& arguments, const std::string& command);

}  // namespace rigmap
