// The command line: rigmap part, run, plan, join, evaluate, calibrate, compare, report, options,
// stages.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "core/console.h"
#include "core/error.h"
#include "core/freed_memory.h"
#include "pipeline/code_identity.h"
#include "workflows/calibrate.h"
#include "workflows/command_documents.h"
#include "workflows/compare_arguments.h"
#include "workflows/evaluate_part.h"
#include "workflows/join.h"
#include "workflows/join_recipe.h"
#include "workflows/part_arguments.h"
#include "workflows/print_options.h"
#include "workflows/print_stages.h"
#include "workflows/recipes.h"
#include "workflows/reconstruct_part.h"
#include "workflows/report.h"
#include "workflows/shell_word.h"
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
    Say("rigmap: {}: {}\n", gates.empty() ? "NOT TRUSTED" : "and", cause.found);
    for (const Gate& gate : cause.gates) gates.push_back(FigureText(gate));
    if (std::ranges::find(advice, cause.advice) == advice.end()) advice.push_back(cause.advice);
  }
  Say("rigmap: usable all the same: {}\n", refusal.usable);
  for (const std::string& sentence : advice) {
    Say("rigmap: to try next: {}\n", sentence);
  }
  const auto report = fs::path(out) / "report.html";
  if (fs::exists(report)) Say("rigmap: report: {}\n", report.string());
  Say("rigmap: what lies in {} is not to be trusted: {}\n", out, fmt::join(gates, "; "));
}

// What a run has come to, said at its end.
int SayHowItEnded(const PartResult& result, const PartArguments& arguments) {
  if (result.status == PartStatus::kUntrusted) {
    SayWhyNot(result.refusal, arguments.out);
    return kExitUntrusted;
  }
  if (!arguments.quiet) {
    const bool partial = result.status == PartStatus::kPartial;
    Say("{}rigmap: {}{}; results in {}\n", result.summarised ? VerdictLines(arguments.out) : "",
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

// Commands that print what is asked for and reconstruct nothing.
class SmallCommands {
 public:
  explicit SmallCommands(CLI::App& app) : app_(app) {
    evaluation_ = app.add_subcommand("evaluate", "Compare a result with a truth");
    evaluation_->add_option("out", evaluate_.out, "Folder with the results")->required();
    evaluation_->add_option("--truth", truth_, "TUM file, track of a prism, or folder with one");
    evaluation_->add_flag("--json", evaluate_.json, "Print one line of JSON instead of a table");
    calibration_ = app.add_subcommand("calibrate", "Find one rig for many parts");
    calibration_->add_option("outs", outs_, "Folders with the results of parts")->required();
    calibration_->add_option("--rig-out", rig_out_, "Rig file to be written")->required();
    options_ = app.add_subcommand("options", "Print every option of part with its default");
    options_->add_option("--format", format_, "yaml or markdown");
    stages_ = app.add_subcommand("stages", "Print the stages of a technique as a table");
    stages_->add_option("--technique", technique_, "rig (default), another, or join");
    report_ = app.add_subcommand("report", "Write report.html into folders with results");
    report_->add_option("outs", reported_, "Folders of parts, traverses or comparisons")
        ->required();
    completion_ = app.add_subcommand("completion", "Print what completes words in bash");
    manual_ = app.add_subcommand("manual", "Print this as a page of manual, for man -l -");
  }

  // False if none of them was asked for.
  bool Run() {
    if (evaluation_->parsed()) {
      evaluate_.truth = IfGiven<fs::path>(truth_);
      PrintResult(EvaluatePart(evaluate_));
      return true;
    }
    if (calibration_->parsed()) {
      calibrate_.outs.assign(outs_.begin(), outs_.end());
      calibrate_.rig_out = rig_out_;
      PrintResult(Calibrate(calibrate_));
      return true;
    }
    if (report_->parsed()) {
      PrintResult(WriteReports({reported_.begin(), reported_.end()}));
      return true;
    }
    if (completion_->parsed() || manual_->parsed()) {
      PrintResult(completion_->parsed() ? BashCompletion(app_) : ManualPage(app_));
      return true;
    }
    if (options_->parsed()) {
      PrintResult(PrintOptions(format_));
      return true;
    }
    if (stages_->parsed()) {
      PrintResult(PrintStages(technique_ == "join"
                                  ? JoinRecipe({}, {}, {}, {}, SplitFixes(), {})
                                  : MakeRecipe(ParseTechnique(technique_), {}, {}, {})));
      return true;
    }
    return false;
  }

 private:
  const CLI::App& app_;
  EvaluateRequest evaluate_;
  std::string truth_;
  CLI::App* evaluation_ = nullptr;
  CalibrateRequest calibrate_;
  std::vector<std::string> outs_;
  std::string rig_out_;
  CLI::App* calibration_ = nullptr;
  std::string format_ = "yaml";
  CLI::App* options_ = nullptr;
  std::string technique_ = "rig";
  CLI::App* stages_ = nullptr;
  std::vector<std::string> reported_;
  CLI::App* report_ = nullptr;
  CLI::App* completion_ = nullptr;
  CLI::App* manual_ = nullptr;
};

bool HasCommand(const CLI::App& app, const std::string& name) {
  return std::ranges::any_of(app.get_subcommands([](const CLI::App*) { return true; }),
                             [&](const CLI::App* command) { return command->get_name() == name; });
}

// For Ctrl-C: only what is allowed in a handler.
void SayHowToGoOn(int signal) {
  constexpr std::string_view kSentence =
      "\nrigmap: interrupted; the same command again goes on from here\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kSentence.data(), kSentence.size());
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// Where it goes on, and Ctrl-C is not meant for the shell alone.
void LetGoOnAfterInterrupt() {
  if (std::signal(SIGINT, SayHowToGoOn) == SIG_IGN) std::signal(SIGINT, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a write that fails, and is named
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
  CompareArguments compare;
  CLI::App* comparison = AddCompare(app, compare);
  SmallCommands small(app);
  AddExamples(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc > 1 && argv[1][0] != '-' && !HasCommand(app, argv[1])) {
      throw UsageError(fmt::format("{}: no such command (--help lists what there is)", argv[1]));
    }
    // What is missing may be there, misspelt.
    const std::vector<std::string> unknown = app.remaining(true);
    if (!unknown.empty() && dynamic_cast<const CLI::RequiredError*>(&error)) {
      throw UsageError(
          fmt::format("{}: no such argument (--help lists what there is)", unknown[0]));
    }
    throw UsageError(fmt::format("{} (--help lists what there is)", error.what()));
  }
  for (const CLI::App* subcommand : app.get_subcommands()) {
    for (const CLI::Option* option : subcommand->get_options()) {
      for (const std::string& value : option->results()) {
        if (!value.empty()) continue;
        throw UsageError(fmt::format("{}: expected a value, found ''", option->get_name()));
      }
    }
  }
  std::string command;
  for (int i = 0; i < argc; ++i) command += (i ? " " : "") + ShellWord(argv[i]);
  if (small.Run()) return 0;
  if (planning->parsed()) {
    PrintResult(PrintPlan(plan));
    return 0;
  }
  LetGoOnAfterInterrupt();
  if (comparison->parsed()) {
    PrintResult(Compare(MakeCompareRequest(compare, command)));
    return 0;
  }
  if (running->parsed()) return RunWhole(run, std::move(command));
  if (joining->parsed()) return RunJoin(join, std::move(command));
  return RunPart(part, std::move(command));
}

// One line, whatever input or other programs have put into the sentence.
void SayLast(std::string sentence) {
  std::replace_if(
      sentence.begin(), sentence.end(),
      [](unsigned char character) { return character < ' ' || character == 0x7f; }, ' ');
  Say("rigmap: {}\n", sentence);
}

}  // namespace
}  // namespace rigmap

int main(int argc, char** argv) {
  rigmap::KeepFreedMemory();
  // Until a job has a log of its own: standard output is for what was asked for.
  spdlog::set_default_logger(spdlog::stderr_logger_mt("rigmap"));
  spdlog::set_pattern("%v");
  try {
    return rigmap::Main(argc, argv);
  } catch (const rigmap::UsageError& error) {
    rigmap::SayLast(error.what());
    return rigmap::kExitUsage;
  } catch (const std::exception& error) {
    rigmap::SayLast(rigmap::ReasonOf(error));
    return rigmap::kExitFailed;
  }
}
