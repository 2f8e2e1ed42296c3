#include "workflows/part_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <thread>

#include "core/config_file.h"
#include "core/error.h"
#include "workflows/print_options.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::pair<int, int> ParseFrames(const std::string& text) {
  int first = -1, end = -1;
  const char* stop = text.data() + text.size();
  const auto colon = std::from_chars(text.data(), stop, first);
  const bool has_colon = colon.ec == std::errc() && colon.ptr != stop && *colon.ptr == ':';
  const auto rest = has_colon ? std::from_chars(colon.ptr + 1, stop, end) : colon;
  if (!has_colon || rest.ec != std::errc() || rest.ptr != stop || first < 0 || end <= first) {
    throw UsageError(
        fmt::format("--frames: expected FIRST:END with 0 <= FIRST < END, found '{}'", text));
  }
  return {first, end};
}

// What a part is made from and how good it has to be: of all commands that reconstruct one.
CLI::Option* AddPartInputs(CLI::App* part, PartArguments& a) {
  CLI::Option* dataset =
      part->add_option("--dataset", a.dataset, "Katwijk root or part, or stereo folder");
  part->add_option("--traverse", a.traverse, "Traverse of a Katwijk root");
  part->add_option("--part", a.part, "Part of the traverse");
  part->add_option("--rig", a.rig, "Rig file, instead of the one beside the data");
  part->add_option("--format", a.format, "katwijk or stereo, instead of what is recognised");
  part->add_option("--frames", a.frames, "FIRST:END of the paired frames, END excluded");
  part->add_option("--config", a.config, "YAML file of options (rigmap options lists all)");
  part->add_option("--set", a.assignments, "stage.option=value, over --config");
  part->add_option(
      "--accuracy", a.accuracy_pct,
      "Per cent of the path that scale and positions must be good to (95 %); default 1");
  part->add_option("--threads", a.threads, "Threads; default: one per core");
  part->add_option("--memory", a.memory_mb, "Megabytes that dense matching may use");
  part->add_option("--truth", a.truth, "TUM file, track of a prism, or folder with one");
  part->add_flag("--quiet", a.quiet, "No progress, errors only");
  return dataset;
}

// The place of a stage in the technique's order.
std::ptrdiff_t IndexOfStage(const char* option, const std::string& name, Technique technique) {
  const auto names = StageNames(technique);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw UsageError(
        fmt::format("{}: expected one of {}, found '{}'", option, fmt::join(names, ", "), name));
  }
  return found - names.begin();
}

void RequireStages(const PartArguments& a, Technique technique) {
  const auto until = a.until.empty() ? 0 : IndexOfStage("--until", a.until, technique);
  const auto from = a.from.empty() ? 0 : IndexOfStage("--from", a.from, technique);
  if (!a.until.empty() && !a.from.empty() && until < from) {
    throw UsageError(fmt::format("--from {}: comes after --until {}", a.from, a.until));
  }
}

}  // namespace

void AddPart(CLI::App& app, PartArguments& a) {
  CLI::App* part = app.add_subcommand("part", "Reconstruct one part of a traverse");
  AddPartInputs(part, a)->required();
  part->add_option("--out", a.out, "Folder for the results")->required();
  part->add_option("--technique", a.technique,
                   "How the part is reconstructed: rig (default), or another for comparison "
                   "(docs/techniques.md)");
  part->add_option("--until", a.until, "Do no more than this stage and what it depends on");
  part->add_option("--from", a.from, "Do this stage and those that depend on it anew");
  part->add_flag("--force", a.force, "Remove an earlier result from the output folder first");
  part->add_flag(
      "--depth-maps", a.depth_maps,
      "Write each keyframe's depth and its sigma as images, and a workspace for COLMAP's "
      "fusion and meshing (dense.depth_maps)");
  part->footer(PartOptionsHelp);
}

PartRequest MakeRequest(const PartArguments& a, std::string command) {
  PartRequest request;
  request.technique = ParseTechnique(a.technique);
  RequireStages(a, request.technique);
  request.dataset.folder = a.dataset;
  request.dataset.traverse = a.traverse;
  request.dataset.part = a.part;
  request.dataset.rig = IfGiven<fs::path>(a.rig);
  request.dataset.format = IfGiven<std::string>(a.format);
  if (!a.frames.empty()) request.dataset.frames = ParseFrames(a.frames);
  request.dataset.default_loccam_rig = ConfigFile("rigs/loccam.yaml");
  request.out = a.out;
  request.options = LoadPartOptions(IfGiven<fs::path>(a.config), a.assignments);
  if (a.accuracy_pct) {
    request.options.gates.poses.accuracy_pct = *a.accuracy_pct;
    RequireValid(request.options.gates);
  }
  request.options.depth_maps.depth_maps |= a.depth_maps;
  request.until = IfGiven<std::string>(a.until);
  request.from = IfGiven<std::string>(a.from);
  request.force = a.force;
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  request.threads = a.threads.value_or(cores);
  if (request.threads < 1) {
    throw UsageError(fmt::format("--threads: expected 1 or more, found {}", request.threads));
  }
  if (a.memory_mb < 256) {
    throw UsageError(fmt::format("--memory: expected at least 256, found {}", a.memory_mb));
  }
  request.memory_mb = a.memory_mb;
  request.truth = IfGiven<fs::path>(a.truth);
  if (request.truth && !fs::exists(*request.truth)) {
    throw DataError(fmt::format("{}: expected a truth, found nothing", a.truth));
  }
  request.quiet = a.quiet;
  request.command = std::move(command);
  return request;
}

CLI::App* AddCompare(CLI::App& app, CompareArguments& a) {
  CLI::App* compare =
      app.add_subcommand("compare",
                         "Reconstruct a part in several ways, and set results side by "
                         "side");
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
  if (a.part.dataset.empty()) return request;
  request.part = MakeRequest(a.part, command);
  request.config = IfGiven<fs::path>(a.part.config);
  request.assignments = a.part.assignments;
  for (const std::string& name : a.techniques) {
    request.techniques.push_back(ParseTechnique(name));
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
