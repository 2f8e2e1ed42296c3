// `rigmap compare`: techniques, settings and repeats side by side.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "workflows/part_request.h"

namespace rigmap {

// One option with the values it is to have.
struct Sweep {
  std::string option;  // "stage.option"
  std::vector<std::string> values;
};

// "stage.option=a,b,c". Throws UsageError for another form; options and values are checked when
// they are used, before anything is run.
Sweep ParseSweep(const std::string& text);

struct CompareRequest {
  std::filesystem::path out;
  std::vector<std::filesystem::path> outs;  // finished results; none: `part` is reconstructed
  // Its technique and `out` are not used. Of a Katwijk folder all parts that fit, each with its own
  // of the truths in a folder of such.
  std::optional<PartRequest> part;
  std::optional<std::filesystem::path> config;
  std::vector<std::string> assignments;  // that the options of `part` were made from
  std::vector<Technique> techniques;
  int repeats = 1;
  std::vector<Sweep> sweeps;
};

// Runs what is missing below out/runs, in folders as `rigmap part` leaves them, and writes
// out/comparison.json and comparison.csv: a row for each run there, also for those that failed or
// were refused. Returns the table of their medians. Throws UsageError and DataError before the
// first run, where options or folders are wrong.
std::string Compare(const CompareRequest& request);

}  // namespace rigmap
