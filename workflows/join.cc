#include "workflows/join.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/file.h"
#include "workflows/join_recipe.h"
#include "workflows/output_folder.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"
#include "workflows/union_of_parts.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// What --truth means for a traverse: a TUM file, a folder with one, or one with a folder for each
// part.
std::string WholeTruth(const fs::path& truth) {
  const fs::path whole = truth / "trajectory.tum";
  const fs::path path = fs::exists(whole) ? whole : truth;
  if (TruthFiles(path).empty()) {
    throw DataError(truth.string() +
                    ": expected trajectory.tum in it or in folders of its parts, found none");
  }
  return fs::absolute(path).string();
}

PartResult Run(const JoinRequest& request, const PartRequest& whole, UnionOfParts united,
               const FolderMark& mark) {
  std::string& truth = united.dataset.truth_path;
  if (whole.truth) truth = WholeTruth(*whole.truth);
  if (!truth.empty()) ReadTruth(truth);
  united.parts.missing.insert(united.parts.missing.begin(), request.missing.begin(),
                              request.missing.end());
  std::optional<SplitFixes> tie_to;
  if (request.use_rtk) {
    tie_to = SplitByTurns(united.dataset.fixes);
    united.dataset.fixes = tie_to->judging;
  }
  Job job(whole.threads, whole.quiet);
  const auto recipe = [&](const Dataset& dataset, const DatasetContent& content) {
    return JoinRecipe(dataset, content, united.parts, united.depths, tie_to, whole.options);
  };
  return job.Run([&] { return RunInFolder({whole, "join", recipe, mark}, united.dataset, job); });
}

// The names of the parts of each world, as the run has found them; empty where it did not come to
// that.
std::vector<std::vector<std::string>> WorldsIn(const fs::path& out) {
  const auto summary = nlohmann::json::parse(ReadTextFile(out / "summary.json"));
  return summary.value("worlds", std::vector<std::vector<std::string>>());
}

// The folders of the largest world; the others are named.
JoinRequest LargestWorld(const JoinRequest& request,
                         const std::vector<std::vector<std::string>>& worlds) {
  JoinRequest largest = request;
  std::erase_if(largest.outs, [&](const fs::path& out) {
    const std::string name = PartName(out);
    if (std::ranges::count(worlds.front(), name)) return false;
    largest.missing.push_back(fmt::format(
        "part {} could not be tied to part{} {}: it stays by itself in {}", name,
        worlds.front().size() > 1 ? "s" : "", fmt::join(worlds.front(), ", "), out.string()));
    spdlog::warn("{}", largest.missing.back());
    return true;
  });
  return largest;
}

}  // namespace

PartResult JoinParts(const JoinRequest& request) {
  cv::setNumThreads(1);  // the work is split over frames
  const PartRequest& whole = request.whole;
  UnionOfParts united = UniteParts(request.outs, whole.out);
  const FolderMark mark = united.Mark();
  const std::vector<std::string> stages = JoinStageNames();
  const auto adjustment = std::ranges::find(stages, "adjustment");
  const auto until = std::ranges::find(stages, whole.until.value_or(stages.back()));
  if (until <= adjustment) return Run(request, whole, std::move(united), mark);

  // First as far as it shows which parts hang together.
  PartRequest posed = whole;
  posed.until = "adjustment";
  Run(request, posed, united, mark);
  const auto worlds = WorldsIn(whole.out);
  PartRequest rest = whole;
  rest.force = false;
  if (worlds.size() < 2) return Run(request, rest, std::move(united), mark);
  const JoinRequest largest = LargestWorld(request, worlds);
  return Run(largest, rest, UniteParts(largest.outs, whole.out), mark);
}

}  // namespace rigmap
