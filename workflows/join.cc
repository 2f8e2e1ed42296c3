#include "workflows/join.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/artefact.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/json_text.h"
#include "pipeline/code_identity.h"
#include "pipeline/ledger.h"
#include "workflows/join_recipe.h"
#include "workflows/output_folder.h"
#include "workflows/reconstruct_part.h"
#include "workflows/run_in_folder.h"
#include "workflows/stages/compare_result.h"
#include "workflows/truth_files.h"
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
  if (request.use_rtk) tie_to = SplitByTurns(united.dataset.fixes);
  Job job(whole.threads, whole.quiet);
  const auto recipe = [&](const Dataset& dataset, const DatasetContent& content) {
    return JoinRecipe(dataset, content, united.parts, united.depths, tie_to, whole.options);
  };
  return job.Run([&] { return RunInFolder({whole, "join", recipe, mark}, united.dataset, job); });
}

// The names of the parts of each world.
using Worlds = std::vector<std::vector<std::string>>;

// As the run has found them; empty where it did not come to that.
Worlds WorldsIn(const fs::path& out) {
  const fs::path path = out / "summary.json";
  return TakeFromJson(path, "the summary of a join", [&] {
    return nlohmann::json::parse(ReadTextFile(path)).value("worlds", Worlds());
  });
}

// What an adjustment of all parts has told of several worlds is kept beside these: the output
// itself then is of the largest, and the same command again is to go on from there.
class WorldsFile {
 public:
  WorldsFile(const JoinRequest& request, const std::vector<PartFolder>& folders)
      : path_(request.whole.out / kWorldsFolder / "worlds.json") {
    std::string text(SourceVersion());
    text += WritePartOptions(request.whole.options);
    for (const PartFolder& folder : folders) {
      text += folder.name;
      for (const StageRecord& record : ReadLedger(folder.root).stages) text += record.key;
    }
    key_ = HashText(text);
  }

  // Empty where nothing is known of these parts with these options by this program.
  Worlds Read() const {
    if (!fs::exists(path_)) return {};
    const auto file = nlohmann::json::parse(ReadTextFile(path_), nullptr, false);
    if (!file.is_object() || !file.contains("key") || file["key"] != key_) return {};
    return TakeFromJson(path_, "the worlds of a join",
                        [&] { return file.value("worlds", Worlds()); });
  }
  void Write(const Worlds& worlds) const {
    fs::create_directories(path_.parent_path());
    WriteFileAtomically(path_, [&](std::ostream& stream) {
      stream << JsonText(nlohmann::json{{"key", key_}, {"worlds", worlds}}, 1) << "\n";
    });
  }
  void Remove() const { fs::remove(path_); }

 private:
  fs::path path_;
  std::string key_;
};

std::vector<PartFolder> FoldersOf(const std::vector<std::string>& world,
                                  const std::vector<PartFolder>& folders) {
  std::vector<PartFolder> of_world;
  std::ranges::copy_if(folders, std::back_inserter(of_world), [&](const PartFolder& folder) {
    return std::ranges::count(world, folder.name) > 0;
  });
  return of_world;
}

std::string Named(const std::vector<std::string>& parts) {
  return fmt::format("part{} {}", parts.size() > 1 ? "s" : "", fmt::join(parts, ", "));
}

// What an earlier join has left, and nothing else.
void RemoveWorlds(const fs::path& others) {
  if (!fs::is_directory(others)) return;
  std::vector<fs::path> own;
  for (const auto& entry : fs::directory_iterator(others)) {
    if (entry.is_directory() && MarkIn(entry.path())) own.push_back(entry.path());
  }
  for (const fs::path& world : own) fs::remove_all(world);
  if (fs::is_empty(others)) fs::remove(others);
}

// Does what is left to do of a world beside the largest, by itself, and says where that lies.
std::string JoinBeside(const std::vector<PartFolder>& folders, const fs::path& out,
                       const JoinRequest& request) {
  if (folders.size() == 1) {
    return fmt::format("it stays by itself in {}", folders.front().root.string());
  }
  JoinRequest beside = request;
  beside.missing.clear();
  beside.whole.out = out;
  beside.outs.clear();
  for (const PartFolder& folder : folders) beside.outs.push_back(folder.root);
  try {
    JoinParts(beside);
  } catch (const std::exception& error) {  // of whatever kind: the largest can be done
    return fmt::format("they stay by themselves, since joining them failed: {}", ReasonOf(error));
  }
  return fmt::format("they are joined by themselves in {}", out.string());
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

// What parts say of their keypoints, which a join takes as they are.
template <class Options>
void TakeFrom(const Options& of_part, const fs::path& config, Options& ours) {
  const std::string own = OptionsText(ours);
  if (own == OptionsText(of_part)) return;
  if (own != OptionsText(Options())) {
    throw UsageError(
        fmt::format("{}: expected these options of {}, found others; a join takes the keypoints of "
                    "its parts",
                    config.string(), Options::kSection));
  }
  ours = of_part;
}

PartOptions WithThoseOfParts(PartOptions options, const std::vector<PartFolder>& folders) {
  for (const PartFolder& folder : folders) {
    const fs::path config = folder.root / "config.yaml";
    if (!fs::exists(config)) continue;
    const PartOptions of_part = LoadPartOptions(config, {});
    TakeFrom(of_part.features, config, options.features);
    TakeFrom(of_part.masks, config, options.masks);
  }
  return options;
}

}  // namespace

PartResult JoinParts(const JoinRequest& asked) {
  cv::setNumThreads(1);  // the work is split over frames
  JoinRequest request = asked;
  std::vector<PartFolder> folders = NameParts(request.outs);
  const PartRequest& whole = request.whole;
  RequirePartsElsewhere(whole.out, request.outs);
  UnionOfParts united = UniteParts(folders, whole.out);
  request.whole.options = WithThoseOfParts(std::move(request.whole.options), folders);
  if (request.use_rtk) {
    const StereoRig& rig = united.dataset.rig;
    RequireFixes(rig.source, rig.antenna_in_left.has_value(), united.dataset.fixes.size());
  }
  const FolderMark mark = united.Mark();
  const std::vector<std::string> stages = JoinStageNames();
  const auto adjustment = std::ranges::find(stages, "adjustment");
  const auto until = std::ranges::find(stages, whole.until.value_or(stages.back()));
  if (until <= adjustment) {
    JoinRequest by_images = request;
    by_images.use_rtk = false;
    if (request.use_rtk) {
      spdlog::warn("--use-rtk: the fixes come in after the adjustment; up to {} they do nothing",
                   *whole.until);
    }
    return Run(by_images, whole, std::move(united), mark);
  }

  const WorldsFile file(request, folders);
  const fs::path others = whole.out / kWorldsFolder;
  Worlds worlds = whole.from || whole.force ? Worlds() : file.Read();
  if (worlds.empty()) {
    // First as far as it shows which parts hang together.
    PartRequest posed = whole;
    posed.until = "adjustment";
    Run(request, posed, united, mark);
    file.Remove();
    RemoveWorlds(others);
    worlds = WorldsIn(whole.out);
    if (worlds.size() > 1) file.Write(worlds);
  }
  const PartRequest rest = AfterAdjustment(request, stages);
  if (worlds.size() < 2) return Run(request, rest, std::move(united), mark);
  JoinRequest largest = request;
  largest.whole = rest;
  for (std::size_t i = 1; i < worlds.size(); ++i) {
    largest.missing.push_back(fmt::format(
        "{} could not be tied to {}: {}", Named(worlds[i]), Named(worlds.front()),
        JoinBeside(FoldersOf(worlds[i], folders), others / fmt::format("{}", i + 1), request)));
    spdlog::warn("{}", largest.missing.back());
  }
  return Run(largest, rest, UniteParts(FoldersOf(worlds.front(), folders), whole.out), mark);
}

}  // namespace rigmap
