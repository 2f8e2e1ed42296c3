#include "workflows/join.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/file.h"
#include "workflows/evaluate_part.h"
#include "workflows/join_recipe.h"
#include "workflows/output_folder.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"
#include "workflows/union_of_parts.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

PartResult Run(const JoinRequest& request, const PartRequest& whole, UnionOfParts united,
               const FolderMark& mark) {
  std::string& truth = united.dataset.truth_path;
  if (whole.truth) truth = fs::absolute(WholeTruth(*whole.truth)).string();
  if (!truth.empty()) RequireTruth(truth);
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

// Takes the folders away that are not of the largest world; a sentence for each.
std::vector<std::string> KeepLargestWorld(const std::vector<std::vector<std::string>>& worlds,
                                          std::vector<PartFolder>& folders) {
  std::vector<std::string> missing;
  std::erase_if(folders, [&](const PartFolder& folder) {
    if (std::ranges::count(worlds.front(), folder.name)) return false;
    missing.push_back(
        fmt::format("part {} could not be tied to part{} {}: it stays by itself in {}", folder.name,
                    worlds.front().size() > 1 ? "s" : "", fmt::join(worlds.front(), ", "),
                    folder.root.string()));
    spdlog::warn("{}", missing.back());
    return true;
  });
  return missing;
}

// What is left to do once all has been adjusted as asked: what --from names must not be done again,
// but what depends on it is still to be done anew.
PartRequest AfterAdjustment(const JoinRequest& request, const std::vector<std::string>& stages) {
  PartRequest rest = request.whole;
  rest.force = false;
  if (!rest.from) return rest;
  const auto from = std::ranges::find(stages, *rest.from);
  if (from <= std::ranges::find(stages, "adjustment"))
    rest.from = request.use_rtk ? "rtk" : "dense";
  return rest;
}

void RequireRtkFor(const JoinRequest& request) {
  if (request.use_rtk) return;
  for (const auto& [option, stage] :
       {std::pair("--from", request.whole.from), std::pair("--until", request.whole.until)}) {
    if (stage != "rtk") continue;
    throw UsageError(fmt::format("{} rtk: expected --use-rtk beside it, found none", option));
  }
}

}  // namespace

PartResult JoinParts(const JoinRequest& request) {
  cv::setNumThreads(1);  // the work is split over frames
  const PartRequest& whole = request.whole;
  RequireRtkFor(request);
  std::vector<PartFolder> folders = NameParts(request.outs);
  RequirePartsElsewhere(whole.out, request.outs);
  UnionOfParts united = UniteParts(folders, whole.out);
  if (request.use_rtk) {
    const StereoRig& rig = united.dataset.rig;
    RequireFixes(rig.source, rig.antenna_in_left.has_value(), united.dataset.fixes.size());
  }
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
  const PartRequest rest = AfterAdjustment(request, stages);
  if (worlds.size() < 2) return Run(request, rest, std::move(united), mark);
  JoinRequest largest = request;
  for (std::string& sentence : KeepLargestWorld(worlds, folders)) {
    largest.missing.push_back(std::move(sentence));
  }
  return Run(largest, rest, UniteParts(folders, whole.out), mark);
}

}  // namespace rigmap
