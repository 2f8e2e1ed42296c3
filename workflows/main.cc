// The command line: rigmap part, rigmap evaluate.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "core/config_file.h"
#include "core/error.h"
#include "core/freed_memory.h"
#include "pipeline/code_identity.h"
#include "workflows/calibrate.h"
#include "workflows/evaluate_part.h"
#include "workflows/print_options.h"
#include "workflows/print_stages.h"
#include "workflows/reconstruct_part.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr int kExitFailed = 1, kExitUsage = 2, kExitUntrusted = 3;

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

struct PartArguments {
  std::string dataset, out, rig, config, frames, format, until, from, truth;
  std::string technique = "rig";
  std::optional<int> traverse, part, threads;
  std::optional<double> accuracy_pct;
  int memory_mb = 2048;
  std::vector<std::string> assignments;
  bool force = false, quiet = false, depth_maps = false;
};

void AddPart(CLI::App& app, PartArguments& a) {
  CLI::App* part = app.add_subcommand("part", "Reconstruct one part of a traverse");
  part->add_option("--dataset", a.dataset, "Katwijk root or part, or stereo folder")->required();
  part->add_option("--traverse", a.traverse, "Traverse of a Katwijk root");
  part->add_option("--part", a.part, "Part of the traverse");
  part->add_option("--rig", a.rig, "Rig file, instead of the one beside the data");
  part->add_option("--format", a.format, "katwijk or stereo, instead of what is recognised");
  part->add_option("--out", a.out, "Folder for the results")->required();
  part->add_option("--technique", a.technique,
                   "rig (default), vo, wheels or filter: how poses are found");
  part->add_option("--frames", a.frames, "FIRST:END of the paired frames, END excluded");
  part->add_option("--config", a.config, "YAML file of options (rigmap options lists all)");
  part->add_option("--set", a.assignments, "stage.option=value, over --config");
  part->add_option(
      "--accuracy", a.accuracy_pct,
      "Per cent of the path that scale and positions must be good to (95 %); default 1");
  part->add_option("--until", a.until, "Do no more than this stage and what it depends on");
  part->add_option("--from", a.from, "Do this stage and those that depend on it anew");
  part->add_flag("--force", a.force, "Remove an earlier result from the output folder first");
  part->add_option("--threads", a.threads, "Threads; default: one per core");
  part->add_option("--memory", a.memory_mb, "Megabytes that dense matching may use");
  part->add_flag(
      "--depth-maps", a.depth_maps,
      "Write each keyframe's depth and its sigma as images, and a workspace for COLMAP's "
      "fusion and meshing (dense.depth_maps)");
  part->add_option("--truth", a.truth, "TUM file, or folder with trajectory.tum");
  part->add_flag("--quiet", a.quiet, "No progress, errors only");
  part->footer(PartOptionsHelp);
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

template <class Value>
std::optional<Value> IfGiven(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional<Value>(text);
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

// A line for each cause, the first cause first, what is usable, what to try; then for scripts the
// gates that speak of it.
void SayWhyNot(const Refusal& refusal, const std::string& out) {
  std::vector<std::string> gates, advice;
  for (const Cause& cause : refusal.causes) {
    fmt::print(stderr, "rigmap: {}: {}\n", gates.empty() ? "NOT TRUSTED" : "and", cause.found);
    for (const Gate& gate : cause.gates) gates.push_back(FigureText(gate));
    if (std::ranges::find(advice, cause.advice) == advice.end()) advice.push_back(cause.advice);
  }
  fmt::print(stderr, "rigmap: usable all the same: {}\n", refusal.usable);
  for (const std::string& sentence : advice) {
    fmt::print(stderr, "rigmap: to try next: {}\n", sentence);
  }
  fmt::print(stderr, "rigmap: what lies in {} is not to be trusted: {}\n", out,
             fmt::join(gates, "; "));
}

int RunPart(const PartArguments& arguments, std::string command) {
  const PartResult result = ReconstructPart(MakeRequest(arguments, std::move(command)));
  if (result.status == PartStatus::kUntrusted) {
    SayWhyNot(result.refusal, arguments.out);
    return kExitUntrusted;
  }
  if (!arguments.quiet) {
    const bool partial = result.status == PartStatus::kPartial;
    fmt::print(stderr, "rigmap: {}, {}; results in {}\n",
               arguments.until.empty() ? "done" : "done up to " + arguments.until,
               partial ? result.reason : result.verdict, arguments.out);
  }
  return 0;
}

int Main(int argc, char** argv) {
  CLI::App app("Metric trajectories and maps from stereo rovers", "rigmap");
  app.set_version_flag("--version", std::string(SourceVersion()));
  app.require_subcommand(1);
  PartArguments part;
  AddPart(app, part);
  EvaluateRequest evaluate;
  std::string truth;
  CLI::App* evaluation = app.add_subcommand("evaluate", "Compare a result with a truth");
  evaluation->add_option("out", evaluate.out, "Folder with the results")->required();
  evaluation->add_option("--truth", truth, "TUM file, or folder with trajectory.tum");
  evaluation->add_flag("--json", evaluate.json, "Print one line of JSON instead of a table");
  CalibrateRequest calibrate;
  std::vector<std::string> outs;
  std::string rig_out;
  CLI::App* calibration = app.add_subcommand("calibrate", "Find one rig for many parts");
  calibration->add_option("outs", outs, "Folders with the results of parts")->required();
  calibration->add_option("--rig-out", rig_out, "Rig file to be written")->required();
  std::string format = "yaml";
  CLI::App* options = app.add_subcommand("options", "Print every option of part with its default");
  options->add_option("--format", format, "yaml or markdown");
  std::string technique = "rig";
  CLI::App* stages = app.add_subcommand("stages", "Print the stages of a technique as a table");
  stages->add_option("--technique", technique, "rig (default), vo, wheels or filter");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    throw UsageError(fmt::format("{} (--help lists what there is)", error.what()));
  }
  std::string command;
  for (int i = 0; i < argc; ++i) command += fmt::format("{}{}", i ? " " : "", argv[i]);
  if (evaluation->parsed()) {
    evaluate.truth = IfGiven<fs::path>(truth);
    fmt::print("{}", EvaluatePart(evaluate));
    return 0;
  }
  if (calibration->parsed()) {
    calibrate.outs.assign(outs.begin(), outs.end());
    calibrate.rig_out = rig_out;
    fmt::print("{}", Calibrate(calibrate));
    return 0;
  }
  if (options->parsed()) {
    fmt::print("{}", PrintOptions(format));
    return 0;
  }
  if (stages->parsed()) {
    fmt::print("{}", PrintStages(ParseTechnique(technique)));
    return 0;
  }
  return RunPart(part, std::move(command));
}

// For Ctrl-C: only what is allowed in a handler.
void SayHowToGoOn(int signal) {
  constexpr std::string_view kSentence =
      "\nrigmap: interrupted; the same command again goes on from here\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kSentence.data(), kSentence.size());
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// One line, whatever input or other programs have put into the sentence.
void SayLast(std::string sentence) {
  std::replace_if(
      sentence.begin(), sentence.end(),
      [](unsigned char character) { return character < ' ' || character == 0x7f; }, ' ');
  fmt::print(stderr, "rigmap: {}\n", sentence);
}

}  // namespace
}  // namespace rigmap

int main(int argc, char** argv) {
  rigmap::KeepFreedMemory();
  std::signal(SIGINT, rigmap::SayHowToGoOn);
  try {
    return rigmap::Main(argc, argv);
  } catch (const rigmap::UsageError& error) {
    rigmap::SayLast(error.what());
    return rigmap::kExitUsage;
  } catch (const std::filesystem::filesystem_error& error) {
    rigmap::SayLast(fmt::format("{}: {}", error.path1().string(), error.code().message()));
    return rigmap::kExitFailed;
  } catch (const std::exception& error) {
    rigmap::SayLast(error.what());
    return rigmap::kExitFailed;
  }
}
