#include "workflows/part_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/config_file.h"
#include "core/error.h"
#include "core/job.h"
#include "core/json_text.h"
#include "workflows/join_recipe.h"
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

// How frames are reconstructed, and how good the result has to be.
void AddHow(CLI::App* command, PartArguments& a) {
  command->add_option("--config", a.config, "YAML file of options (rigmap options lists all)");
  command->add_option("--set", a.assignments, "section.option=value, over --config");
  command->add_option(
      "--accuracy", a.accuracy_pct,
      "Per cent of the path that scale and positions must be good to (95 %), over --config; "
      "default 1");
  command->add_option("--threads", a.threads, "Threads; default: one per core");
  command->add_option(
      "--memory", a.memory_mb,
      "Megabytes that the process may take, default 2048; keypoints, depth and fusion keep "
      "to it");
  command->add_option("--truth", a.truth, "TUM file, track of a prism, or folder with one");
  command->add_flag("--quiet", a.quiet, "No progress, errors only");
}

// Where the results go, and how much is done.
void AddWhere(CLI::App* command, PartArguments& a) {
  command->add_option("--out", a.out, "Folder for the results")->required();
  command->add_option("--until", a.until, "Do no more than this stage and what it depends on");
  command->add_option("--from", a.from, "Do this stage and those that depend on it anew");
  command->add_flag("--force", a.force, "Remove an earlier result from the output folder first");
  command->add_flag(
      "--depth-maps", a.depth_maps,
      "Write the depth of each frame of the map and its sigma as images, and a workspace for "
      "COLMAP's fusion and meshing (dense.depth_maps)");
}

void AddUseRtk(CLI::App* command, bool& use_rtk) {
  command->add_flag("--use-rtk", use_rtk,
                    "Tie the poses to satellite fixes: those of every other ten seconds; the "
                    "others judge");
}

// How a traverse is cut into jobs.
void AddCuts(CLI::App* command, RunArguments& a) {
  command->add_option("--split", a.split, "Cut the traverse into so many jobs");
  command->add_option("--max-frames", a.max_frames, "Cut it into jobs of at most so many pairs");
  command->add_option("--overlap", a.overlap,
                      "Pairs that jobs cut from one part share, default 10");
}

// The place of a stage in the technique's order.
std::ptrdiff_t IndexOfStage(const char* option, const std::string& name,
                            const std::vector<std::string>& names) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw UsageError(
        fmt::format("{}: expected one of {}, found '{}'", option, fmt::join(names, ", "), name));
  }
  return found - names.begin();
}

void RequireStages(const PartArguments& a, const std::vector<std::string>& stages) {
  const auto until = a.until.empty() ? 0 : IndexOfStage("--until", a.until, stages);
  const auto from = a.from.empty() ? 0 : IndexOfStage("--from", a.from, stages);
  if (!a.until.empty() && !a.from.empty() && until < from) {
    throw UsageError(fmt::format("--from {}: comes after --until {}", a.from, a.until));
  }
}

constexpr const char* kRtk = "rtk";  // the one stage of a join that comes in by an option

void RequireJoinStages(const PartArguments& whole, bool use_rtk) {
  RequireStages(whole, JoinStageNames());
  for (const auto& [option, stage] :
       {std::pair("--from", whole.from), std::pair("--until", whole.until)}) {
    if (stage != kRtk || use_rtk) continue;
    throw UsageError(fmt::format("{} {}: expected --use-rtk beside it, found none", option, kRtk));
  }
}

// All but what depends on the technique.
PartRequest MakeRequestWithoutStages(const PartArguments& a, std::string command) {
  PartRequest request;
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
    const auto same = std::ranges::find_if(a.assignments, [](const std::string& assignment) {
      return assignment.starts_with("gates.accuracy_pct=");
    });
    if (same != a.assignments.end()) {
      throw UsageError(fmt::format("--accuracy {}: expected no --set of the same, found {}",
                                   *a.accuracy_pct, *same));
    }
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

}  // namespace

CLI::Option* AddPartInputs(CLI::App* part, PartArguments& a) {
  CLI::Option* dataset =
      part->add_option("--dataset", a.dataset, "Katwijk root or part, or stereo folder");
  part->add_option("--traverse", a.traverse, "Traverse of a Katwijk root");
  part->add_option("--part", a.part, "Part of the traverse");
  part->add_option("--rig", a.rig, "Rig file, instead of the one beside the data");
  part->add_option("--format", a.format, "katwijk or stereo, instead of what is recognised");
  part->add_option("--frames", a.frames, "FIRST:END of the paired frames, END excluded");
  AddHow(part, a);
  return dataset;
}

void AddPart(CLI::App& app, PartArguments& a) {
  CLI::App* part = app.add_subcommand("part", "Reconstruct one part of a traverse");
  AddPartInputs(part, a)->required();
  part->add_option("--technique", a.technique,
                   "How the part is reconstructed: rig (default), or another for comparison "
                   "(docs/techniques.md)");
  AddWhere(part, a);
  part->footer(PartOptionsHelp);
}

PartRequest MakeRequest(const PartArguments& a, std::string command) {
  const Technique technique = ParseTechnique(a.technique);
  RequireStages(a, StageNames(technique));
  PartRequest request = MakeRequestWithoutStages(a, std::move(command));
  request.technique = technique;
  return request;
}

JoinRequest MakeJoinRequest(const JoinArguments& a, std::string command) {
  JoinRequest request;
  request.outs.assign(a.outs.begin(), a.outs.end());
  PartArguments whole = a.whole;
  const fs::path options = request.outs.front() / "config.yaml";
  if (whole.config.empty() && fs::exists(options)) whole.config = options.string();
  request.whole = MakeRequestWithoutStages(whole, std::move(command));
  request.use_rtk = a.use_rtk;
  request.missing = a.missing;
  RequireJoinStages(whole, a.use_rtk);
  return request;
}

CLI::App* AddJoin(CLI::App& app, JoinArguments& a) {
  CLI::App* join =
      app.add_subcommand("join", "Put the parts of one drive together: one trajectory, one map");
  join->add_option("outs", a.outs, "Folders that rigmap part has left")->required();
  AddHow(join, a.whole);
  AddUseRtk(join, a.use_rtk);
  join->add_option(
          "--missing", a.missing,
          "A sentence on a part that could not be done; may be repeated. What is joined is "
          "then not trusted as the whole")
      ->allow_extra_args(false);
  AddWhere(join, a.whole);
  join->footer(PartOptionsHelp);
  return join;
}

CLI::App* AddRun(CLI::App& app, RunArguments& a) {
  CLI::App* run = app.add_subcommand(
      "run", "Reconstruct a whole traverse: its parts, and the parts joined into one world");
  AddPartInputs(run, a.part)->required();
  AddCuts(run, a);
  AddUseRtk(run, a.use_rtk);
  AddWhere(run, a.part);
  run->footer(PartOptionsHelp);
  return run;
}

CLI::App* AddPlan(CLI::App& app, RunArguments& a) {
  CLI::App* plan = app.add_subcommand(
      "plan", "Look a data set over, and print the jobs that `run` would make of it");
  AddPartInputs(plan, a.part)->required();
  AddCuts(plan, a);
  plan->add_flag("--sbatch", a.sbatch, "Print a script for sbatch instead of JSON");
  plan->footer(PartOptionsHelp);
  return plan;
}

RunRequest MakeRunRequest(const RunArguments& a, std::string command) {
  RunRequest request;
  request.part = MakeRequestWithoutStages(a.part, std::move(command));
  request.use_rtk = a.use_rtk;
  RequireJoinStages(a.part, a.use_rtk);
  PartArguments part = a.part;
  if (part.until == kRtk) part.until = "adjustment";
  if (part.from == kRtk) part.from.clear();
  RequireStages(part, StageNames(Technique::kRig));
  request.part_until = IfGiven<std::string>(part.until);
  request.part_from = IfGiven<std::string>(part.from);
  request.plan = {
      request.part.dataset,   a.split,           a.max_frames, a.overlap, request.part.threads,
      request.part.memory_mb, request.part.truth};
  for (const auto& [option, count] :
       {std::pair("--split", a.split), {"--max-frames", a.max_frames}}) {
    if (count && *count < 1) {
      throw UsageError(fmt::format("{}: expected 1 or more, found {}", option, *count));
    }
  }
  return request;
}

std::string PrintPlan(const RunArguments& a) {
  const RunRequest request = MakeRunRequest(a, "");
  Job job(request.part.threads, request.part.quiet);
  const TraversePlan plan = job.Run([&] { return PlanTraverse(request.plan); });
  if (!a.sbatch) return JsonText(ToJson(plan, request.plan), 1) + "\n";
  std::vector<std::string> more;
  if (!a.part.config.empty()) {
    more.insert(more.end(), {"--config", fs::absolute(a.part.config).string()});
  }
  for (const std::string& assignment : a.part.assignments) {
    more.insert(more.end(), {"--set", assignment});
  }
  if (a.part.accuracy_pct) {
    more.insert(more.end(), {"--accuracy", fmt::format("{}", *a.part.accuracy_pct)});
  }
  return WriteSbatch(plan, request.plan, more);
}

}  // namespace rigmap
