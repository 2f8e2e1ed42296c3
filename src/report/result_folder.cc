#include "report/result_folder.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "colmap/model_io.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

Json ReadJson(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return nullptr;
  return TakeFromJson(path, "JSON", [&] { return Json::parse(ReadTextFile(path)); });
}

void RequireSummary(const Json& summary, const fs::path& root) {
  const bool known = summary.is_object() && summary.contains("status") &&
                     summary["status"].is_string() && summary.contains("stages") &&
                     summary["stages"].is_array();
  if (!known) {
    throw DataError(
        fmt::format("{}: expected a summary with status and stages, as this release of rigmap "
                    "writes it, found another; run rigmap part again",
                    (root / "summary.json").string()));
  }
}

[[noreturn]] void RefuseFolder(const fs::path& root) {
  if (fs::exists(root / ".dataset")) {
    throw DataError(
        fmt::format("{}: expected a finished result, found one without summary.json: a run is at "
                    "work there or was killed; the same command again goes on from it",
                    root.string()));
  }
  throw DataError(fmt::format(
      "{}: expected the results of a run or a comparison, found neither summary.json nor "
      "comparison.json",
      root.string()));
}

std::map<StampNs, fs::path> LeftImages(const fs::path& folder) {
  std::map<StampNs, fs::path> images;
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return images;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    StampNs stamp_ns = 0;
    const auto read = std::from_chars(stem.data(), stem.data() + stem.size(), stamp_ns);
    // A link may lead to where the images were once.
    if (read.ec == std::errc() && fs::exists(entry.path(), ignored)) {
      images.emplace(stamp_ns, entry.path());
    }
  }
  return images;
}

std::vector<PartOfTraverse> ReadParts(const fs::path& folder) {
  std::vector<PartOfTraverse> parts;
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return parts;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_directory()) continue;
    parts.push_back({entry.path().filename().string(), ReadJson(entry.path() / "summary.json"),
                     ReadJson(entry.path() / "evaluation.json")});
  }
  std::ranges::sort(parts, {}, &PartOfTraverse::name);
  return parts;
}

// What a report can do without.
template <class Read>
auto UnlessDamaged(const Read& read) -> decltype(read()) {
  try {
    return read();
  } catch (const DataError& error) {
    spdlog::warn("left out of the report: {}", error.what());
    return {};
  }
}

std::string NameOfFolder(const fs::path& root) {
  fs::path whole = fs::absolute(root).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();
  // "result" alone says little.
  return whole.has_parent_path() && whole.parent_path().has_filename()
             ? (whole.parent_path().filename() / whole.filename()).string()
             : whole.filename().string();
}

PoseSource ParsePoseSource(const std::string& name) {
  for (const PoseSource source :
       {PoseSource::kAdjusted, PoseSource::kOdometry, PoseSource::kPredicted}) {
    if (Name(source) == name) return source;
  }
  throw std::invalid_argument(name);
}

TimedPose ParsePoseRow(const std::string& line) {
  std::istringstream cells(line);
  const auto next = [&] {
    std::string cell;
    if (!std::getline(cells, cell, ',')) throw std::invalid_argument(line);
    return cell;
  };
  const auto number = [&] { return std::stod(next()); };
  TimedPose pose;
  pose.stamp_ns = std::stoll(next());
  for (int i = 0; i < 3; ++i) pose.world_from_left.translation[i] = number();
  for (int i = 0; i < 4; ++i) pose.world_from_left.rotation.coeffs()[i] = number();
  for (int i = 0; i < 6; ++i) pose.sigmas[i] = number();
  pose.source = ParsePoseSource(next());
  pose.keyframe = next() == "1";
  return pose;
}

ResultFolder ReadSummaries(const fs::path& root) {
  std::error_code ignored;
  if (!fs::is_directory(root, ignored)) {
    throw DataError(fmt::format("{}: expected a folder with results, found {}", root.string(),
                                fs::exists(root, ignored) ? "a file" : "nothing"));
  }
  ResultFolder folder{.root = root, .name = NameOfFolder(root)};
  folder.comparison = ReadJson(root / "comparison.json");
  folder.summary = ReadJson(root / "summary.json");
  if (folder.summary.is_null() && folder.comparison.is_null()) RefuseFolder(root);
  if (!folder.summary.is_null()) {
    RequireSummary(folder.summary, root);
    return folder;
  }
  if (!folder.comparison.contains("rows") || !folder.comparison["rows"].is_array()) {
    throw DataError(fmt::format("{}: expected the rows of a comparison, found none",
                                (root / "comparison.json").string()));
  }
  folder.kind = ResultKind::kComparison;
  return folder;
}

}  // namespace

void RequireResult(const fs::path& root) { ReadSummaries(root); }

Trajectory ReadTrajectoryCsv(const fs::path& path) {
  std::istringstream text(ReadTextFile(path));
  std::string line;
  std::getline(text, line);
  Trajectory trajectory;
  for (int number = 2; std::getline(text, line); ++number) {
    try {
      trajectory.push_back(ParsePoseRow(line));
    } catch (const std::logic_error&) {
      throw DataError(fmt::format("{}:{}: expected a pose as trajectory.csv has them, found '{}'",
                                  path.string(), number, line));
    }
  }
  return trajectory;
}

std::vector<double> DistancesAlong(const Trajectory& trajectory) {
  std::vector<double> distances;
  double sum = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (i > 0) {
      sum += (trajectory[i].world_from_left.translation -
              trajectory[i - 1].world_from_left.translation)
                 .norm();
    }
    distances.push_back(sum);
  }
  return distances;
}

ResultFolder ReadResultFolder(const fs::path& root) {
  ResultFolder folder = ReadSummaries(root);
  if (folder.kind == ResultKind::kComparison) return folder;
  folder.evaluation = UnlessDamaged([&] { return ReadJson(root / "evaluation.json"); });
  folder.reference = UnlessDamaged([&] { return ReadJson(root / "reference.json"); });
  folder.georeference = UnlessDamaged([&] { return ReadJson(root / "georeference.json"); });
  folder.parts = UnlessDamaged([&] { return ReadParts(root / "parts"); });
  folder.kind = folder.parts.empty() ? ResultKind::kPart : ResultKind::kTraverse;
  if (fs::exists(root / "trajectory.csv")) {
    folder.trajectory = UnlessDamaged([&] { return ReadTrajectoryCsv(root / "trajectory.csv"); });
  }
  if (HasModel(root / "sparse")) {
    folder.sparse = UnlessDamaged([&] { return std::optional(ReadModel(root / "sparse")); });
  }
  folder.images = LeftImages(root / "colmap" / "images" / "left");
  return folder;
}

}  // namespace rigmap
