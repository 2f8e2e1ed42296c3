#include "workflows/stage_runner.h"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include "core/freed_memory.h"

namespace rigmap {
namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Messages of a stage go to its log; warnings and worse also to stderr, unless quiet.
void LogTo(const std::filesystem::path& path, bool quiet) {
  auto file = std::make_shared<spdlog::sinks::basic_file_sink_st>(path.string(), false);
  auto terminal = std::make_shared<spdlog::sinks::stderr_sink_st>();
  terminal->set_level(quiet ? spdlog::level::err : spdlog::level::warn);
  terminal->set_pattern("rigmap: %v");
  auto logger = std::make_shared<spdlog::logger>(
      "rigmap", spdlog::sinks_init_list{std::move(file), std::move(terminal)});
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

// Largest child so far, of all stages.
double ChildrenPeakMb() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::size_t IndexOf(const std::string& name) {
  return static_cast<std::size_t>(std::find(std::begin(kStageNames), std::end(kStageNames), name) -
                                  std::begin(kStageNames));
}

}  // namespace

bool IsStageName(const std::string& name) { return IndexOf(name) < std::size(kStageNames); }

bool ComesBefore(const std::string& a, const std::string& b) { return IndexOf(a) < IndexOf(b); }

StageRunner::StageRunner(StagePlan plan) : plan_(std::move(plan)) {
  std::filesystem::create_directories(plan_.layout.root / "logs");
}

bool StageRunner::MayReuse(const std::string& name) const {
  return !plan_.from || ComesBefore(name, *plan_.from);
}

void StageRunner::Begin(const std::string& name, const std::string& options) {
  LogTo(plan_.layout.Log(name), plan_.quiet);
  ReturnFreedMemory();
  memory_.emplace();
  started_s_ = Now();
  key_ = HashText(key_ + "\n" + name + "\n" + options);
}

void StageRunner::End(const std::string& name, bool reused) {
  const double children_mb = ChildrenPeakMb();
  // The kernel keeps the largest child of all; one that grew it ran in this stage.
  const double child_peak = children_mb > children_peak_mb_ ? children_mb : 0.0;
  children_peak_mb_ = children_mb;
  records_.push_back(
      {name, Now() - started_s_, std::max(memory_->Megabytes(), child_peak), reused});
  memory_.reset();
  spdlog::info("{} {:.3f} s", reused ? "reused," : "done,", records_.back().seconds);
  if (plan_.until == name) throw StopAfterStage();
}

void StageRunner::RemoveFrom(const std::string& name) const {
  std::filesystem::remove(plan_.layout.Artefact(name));
  for (std::size_t i = IndexOf(name); i < std::size(kStageNames); ++i) {
    for (const auto& path : plan_.layout.PublishedBy(std::string(kStageNames[i]))) {
      std::filesystem::remove_all(path);
    }
  }
}

void StageRunner::Discard(const std::string& name) const {
  try {
    RemoveFrom(name);
    std::filesystem::remove_all(plan_.layout.Scratch());
  } catch (const std::filesystem::filesystem_error& error) {
    spdlog::warn("what is left of {} cannot be removed: {}", name, error.what());
  }
}

bool StageRunner::AllExist(const std::vector<std::filesystem::path>& paths) {
  return std::all_of(paths.begin(), paths.end(),
                     [](const auto& path) { return std::filesystem::exists(path); });
}

}  // namespace rigmap
