#include "workflows/truth_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {

namespace fs = std::filesystem;

fs::path TruthFile(const fs::path& truth) {
  if (!fs::is_directory(truth)) return truth;
  for (const char* name : {"trajectory.tum", "groundtruth_tum.txt", "groundtruth_xy.txt"}) {
    if (fs::exists(truth / name)) return truth / name;
  }
  std::vector<std::string> inside;
  for (const auto& entry : fs::directory_iterator(truth)) {
    if (!fs::exists(entry.path() / "trajectory.tum")) continue;
    inside.push_back(entry.path().filename().string());
  }
  std::ranges::sort(inside);
  if (!inside.empty()) {
    throw DataError(
        fmt::format("{}: expected trajectory.tum in it, found {} with one inside; "
                    "name the part, or its folder",
                    truth.string(), fmt::join(inside, ", ")));
  }
  throw DataError(
      fmt::format("{}: expected trajectory.tum, groundtruth_tum.txt or groundtruth_xy.txt in it, "
                  "found none",
                  truth.string()));
}

fs::path WholeTruth(const fs::path& truth) {
  const bool is_of_parts = fs::is_directory(truth) && !fs::exists(truth / "trajectory.tum") &&
                           !TruthFiles(truth).empty();
  return is_of_parts ? truth : TruthFile(truth);
}

std::optional<fs::path> TruthOfPart(const std::optional<fs::path>& truth,
                                    const DatasetRequest& part) {
  if (!truth || !fs::is_directory(*truth) || fs::exists(*truth / "trajectory.tum")) return truth;
  const fs::path own = *truth / fmt::format("Part{}", part.part.value_or(1));
  if (fs::exists(own / "trajectory.tum")) return own;
  const bool has_others =
      std::any_of(fs::directory_iterator(*truth), {}, [](const fs::directory_entry& entry) {
        return entry.path().filename().string().starts_with("Part") &&
               fs::exists(entry.path() / "trajectory.tum");
      });
  return has_others ? std::nullopt : truth;
}

fs::path TruthOfRun(const fs::path& truth, const DatasetRequest& part) {
  return TruthFile(part.part ? TruthOfPart(truth, part).value_or(truth) : truth);
}

}  // namespace rigmap
