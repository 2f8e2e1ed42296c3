// The command line: rigmap part, run, plan, join, evaluate, calibrate, compare, report, options,
// stages.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "core/error.h"
#include "core/freed_memory.h"
#include "pipeline/code_identity.h"
#include "workflows/calibrate.h"
#include "workflows/command_documents.h"
#include "workflows/evaluate_part.h"
#include "workflows/join.h"
#include "workflows/part_arguments.h"
#include "workflows/print_options.h"
#include "workflows/print_stages.h"
#include "workflows/reconstruct_part.h"
#include "workflows/report.h"
#include "workflows/verdict_lines.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr int kExitFailed = 1, kExitUsage = 2, kExitUntrusted = 3;

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
  const auto report = fs::path(out) / "report.html";
  if (fs::exists(report)) fmt::print(stderr, "rigmap: report: {}\n", report.string());
  fmt::print(stderr, "rigmap: what lies in {} is not to be trusted: {}\n", out,
             fmt::join(gates, "; "));
}

// What a run has come to, said at its end.
int SayHowItEnded(const PartResult& result, const PartArguments& arguments) {
  if (result.status == PartStatus::kUntrusted) {
    SayWhyNot(result.refusal, arguments.out);
    return kExitUntrusted;
  }
  if (!arguments.quiet) {
    const bool partial = result.status == PartStatus::kPartial;
    fmt::print(stderr, "{}rigmap: {}{}; results in {}\n", VerdictLines(arguments.out),
               arguments.until.empty() ? "done" : "done up to " + arguments.until,
               partial ? ", " + result.reason : "", arguments.out);
  }
  return 0;
}

int RunPart(const PartArguments& arguments, std::string command) {
  return SayHowItEnded(ReconstructPart(MakeRequest(arguments, std::move(command))), arguments);
}

int RunWhole(const RunArguments& arguments, std::string command) {
  return SayHowItEnded(RunTraverse(MakeRunRequest(arguments, std::move(command))), arguments.part);
}

int RunJoin(const JoinArguments& arguments, std::string command) {
  return SayHowItEnded(JoinParts(MakeJoinRequest(arguments, std::move(command))), arguments.whole);
}

int Main(int argc, char** argv) {
  CLI::App app("Metric trajectories and maps from stereo rovers", "rigmap");
  app.set_version_flag("--version", std::string(SourceVersion()));
  app.require_subcommand(1);
  PartArguments part;
  AddPart(app, part);
  RunArguments run, plan;
  CLI::App* running = AddRun(app, run);
  CLI::App* planning = AddPlan(app, plan);
  JoinArguments join;
  CLI::App* joining = AddJoin(app, join);
  EvaluateRequest evaluate;
  std::string truth;
  CLI::App* evaluation = app.add_subcommand("evaluate", "Compare a result with a truth");
  evaluation->add_option("out", evaluate.out, "Folder with the results")->required();
  evaluation->add_option("--truth", truth, "TUM file, track of a prism, or folder with one");
  evaluation->add_flag("--json", evaluate.json, "Print one line of JSON instead of a table");
  CalibrateRequest calibrate;
  std::vector<std::string> outs;
  std::string rig_out;
  CLI::App* calibration = app.add_subcommand("calibrate", "Find one rig for many parts");
  calibration->add_option("outs", outs, "Folders with the results of parts")->required();
  calibration->add_option("--rig-out", rig_out, "Rig file to be written")->required();
  CompareArguments compare;
  CLI::App* comparison = AddCompare(app, compare);
  std::string format = "yaml";
  CLI::App* options = app.add_subcommand("options", "Print every option of part with its default");
  options->add_option("--format", format, "yaml or markdown");
  std::string technique = "rig";
  CLI::App* stages = app.add_subcommand("stages", "Print the stages of a technique as a table");
  stages->add_option("--technique", technique, "rig (default) or another");
  std::vector<std::string> reported;
  CLI::App* report = app.add_subcommand("report", "Write report.html into folders with results");
  report->add_option("outs", reported, "Folders of parts, traverses or comparisons")->required();
  CLI::App* completion = app.add_subcommand("completion", "Print what completes words in bash");
  CLI::App* manual = app.add_subcommand("manual", "Print this as a page of manual, for man -l -");
  AddExamples(app);
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
  if (comparison->parsed()) {
    fmt::print("{}", Compare(MakeCompareRequest(compare, command)));
    return 0;
  }
  if (report->parsed()) {
    fmt::print("{}", WriteReports({reported.begin(), reported.end()}));
    return 0;
  }
  if (completion->parsed() || manual->parsed()) {
    fmt::print("{}", completion->parsed() ? BashCompletion(app) : ManualPage(app));
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
  if (planning->parsed()) {
    fmt::print("{}", PrintPlan(plan));
    return 0;
  }
  if (running->parsed()) return RunWhole(run, std::move(command));
  if (joining->parsed()) return RunJoin(join, std::move(command));
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
