#include "workflows/compare_arguments.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "core/error.h"
#include "workflows/print_options.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Results that are there are compared as they are.
void RequireNothingToRun(const CompareArguments& a) {
  for (const auto& [option, is_given] : {std::pair("--truth", !a.part.truth.empty()),
                                         {"--accuracy", a.part.accuracy_pct.has_value()},
                                         {"--traverse", a.part.traverse.has_value()},
                                         {"--part", a.part.part.has_value()},
                                         {"--frames", !a.part.frames.empty()},
                                         {"--format", !a.part.format.empty()},
                                         {"--rig", !a.part.rig.empty()},
                                         {"--config", !a.part.config.empty()},
                                         {"--set", !a.part.assignments.empty()},
                                         {"--techniques", !a.techniques.empty()},
                                         {"--repeat", a.repeats != 1},
                                         {"--sweep", !a.sweeps.empty()}}) {
    if (!is_given) continue;
    throw UsageError(fmt::format(
        "{}: expected with --dataset alone, found beside folders with results, which are compared "
        "as they are (rigmap evaluate OUT --truth TRUTH judges one anew)",
        option));
  }
}

}  // namespace

CLI::App* AddCompare(CLI::App& app, CompareArguments& a) {
  CLI::App* compare =
      app.add_subcommand("compare",
                         "Reconstruct a part, or all parts of a traverse, in several "
                         "ways, and set results side by side");
  compare->add_option("outs", a.outs, "Folders with results, instead of --dataset");
  AddPartInputs(compare, a.part);
  compare->add_option("--techniques", a.techniques, "Which of them (rigmap part --technique)")
      ->delimiter(',');
  compare->add_option("--repeat", a.repeats,
                      "Runs of each technique that has chance in it, by other seeds");
  compare->add_option("--sweep", a.sweeps,
                      "stage.option=a,b,c: a run with each value; several give all combinations");
  compare->add_option("--out", a.part.out, "Folder for the comparison and its runs")->required();
  compare->footer(PartOptionsHelp);
  return compare;
}

CompareRequest MakeCompareRequest(const CompareArguments& a, const std::string& command) {
  CompareRequest request;
  request.out = a.part.out;
  request.outs.assign(a.outs.begin(), a.outs.end());
  if (a.outs.empty() == a.part.dataset.empty()) {
    throw UsageError("compare: expected either folders with results or --dataset");
  }
  if (a.part.dataset.empty()) {
    RequireNothingToRun(a);
    return request;
  }
  request.part = MakeRequest(a.part, command);
  request.config = IfGiven<fs::path>(a.part.config);
  request.assignments = a.part.assignments;
  for (const std::string& name : a.techniques) {
    request.techniques.push_back(ParseTechnique(name, "--techniques"));
  }
  if (request.techniques.empty()) {
    for (const char* name : NamesOf(Technique{})) {
      request.techniques.push_back(ParseTechnique(name));
    }
  }
  if (a.repeats < 1) {
    throw UsageError(fmt::format("--repeat: expected 1 or more, found {}", a.repeats));
  }
  request.repeats = a.repeats;
  for (const std::string& sweep : a.sweeps) request.sweeps.push_back(ParseSweep(sweep));
  return request;
}

}  // namespace rigmap
