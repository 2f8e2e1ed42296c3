#include "workflows/join.h"

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "workflows/join_recipe.h"
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

}  // namespace

PartResult JoinParts(const JoinRequest& request) {
  cv::setNumThreads(1);  // the work is split over frames
  const PartRequest& whole = request.whole;
  UnionOfParts united = UniteParts(request.outs, whole.out);
  std::string& truth = united.dataset.truth_path;
  if (whole.truth) truth = WholeTruth(*whole.truth);
  if (!truth.empty()) ReadTruth(truth);
  Job job(whole.threads, whole.quiet);
  const auto recipe = [&](const Dataset& dataset, const DatasetContent& content) {
    return JoinRecipe(dataset, content, united.parts, united.depths, whole.options);
  };
  return job.Run([&] { return RunInFolder({whole, "join", recipe}, united.dataset, job); });
}

}  // namespace rigmap
