#include "evaluation/map_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "export/ply_rows.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr float kNormalUnit = 127.0F;  // the length that unit normals have in the file

fs::path SurfaceFile(const fs::path& folder) { return folder / "surface.ply"; }

// Each once: parts of one drive have theirs in common.
std::vector<fs::path> RocksFiles(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files;
  for (const fs::path& folder : folders) {
    fs::path file = (fs::absolute(folder) / ".." / "rocks.json").lexically_normal();
    if (std::ranges::find(files, file) == files.end()) files.push_back(std::move(file));
  }
  return files;
}

TrueSurface ReadSurface(const fs::path& path, bool kind_needed) {
  PlyRows rows(path);
  const auto x = rows.At({"x", "y", "z"}), normal = rows.At({"nx", "ny", "nz"});
  const PlyProperty& visible = rows.At("visible");
  const PlyProperty* kind = kind_needed ? &rows.At("kind") : rows.Find("kind");
  TrueSurface surface;
  surface.x_in_truth.reserve(rows.size());
  surface.normal.reserve(rows.size());
  surface.visible.reserve(rows.size());
  surface.kind.reserve(rows.size());
  for (std::uint64_t i = 0; i < rows.size(); ++i) {
    const char* row = rows.Next();
    surface.x_in_truth.push_back(rows.FinitePoint(x));
    surface.normal.push_back(rows.FinitePoint(normal) / kNormalUnit);
    surface.visible.push_back(PlyValue(visible, row) > 0.0 ? 1 : 0);
    surface.kind.push_back(kind && PlyValue(*kind, row) == kRockKind ? kRockKind : 0);
  }
  return surface;
}

// Points at the very same place are one.
void Add(const TrueSurface& more, TrueSurface& surface) {
  const auto key = [](const Eigen::Vector3f& x) { return std::array{x.x(), x.y(), x.z()}; };
  std::map<std::array<float, 3>, std::size_t> known;
  for (std::size_t i = 0; i < surface.size(); ++i) known.emplace(key(surface.x_in_truth[i]), i);
  for (std::size_t i = 0; i < more.size(); ++i) {
    const auto found = known.find(key(more.x_in_truth[i]));
    if (found != known.end()) {
      surface.visible[found->second] |= more.visible[i];
      continue;
    }
    surface.x_in_truth.push_back(more.x_in_truth[i]);
    surface.normal.push_back(more.normal[i]);
    surface.visible.push_back(more.visible[i]);
    surface.kind.push_back(more.kind[i]);
  }
}

// Throws nlohmann::json::exception for what is no such rock.
TrueRock RockFromJson(const nlohmann::json& json) {
  TrueRock rock;
  rock.size = json.at("size").get<std::string>();
  rock.x_in_truth = {json.at("x").get<double>(), json.at("y").get<double>(),
                     json.at("z").get<double>()};
  rock.width_m = json.at("width").get<double>();
  return rock;
}

std::vector<TrueRock> ReadRocks(const fs::path& path) {
  std::vector<TrueRock> rocks;
  if (!fs::exists(path)) return rocks;
  try {
    const auto json = nlohmann::json::parse(ReadTextFile(path));
    for (const auto& rock : json.at("rocks")) rocks.push_back(RockFromJson(rock));
  } catch (const nlohmann::json::exception& error) {
    throw DataError(
        fmt::format("{}: expected JSON with 'rocks', each with size, x, y, z and width, found: {}",
                    path.string(), error.what()));
  }
  return rocks;
}

}  // namespace

std::optional<MapTruth> ReadMapTruth(const std::vector<fs::path>& folders) {
  const auto has_surface = [](const fs::path& folder) { return fs::exists(SurfaceFile(folder)); };
  if (folders.empty() || !std::ranges::all_of(folders, has_surface)) return std::nullopt;
  MapTruth truth;
  for (const fs::path& file : RocksFiles(folders)) {
    std::ranges::move(ReadRocks(file), std::back_inserter(truth.rocks));
  }
  for (const fs::path& folder : folders) {
    std::ranges::move(ReadTum(folder / "trajectory.tum"), std::back_inserter(truth.path));
    TrueSurface surface = ReadSurface(SurfaceFile(folder), !truth.rocks.empty());
    if (folder == folders.front()) {
      truth.surface = std::move(surface);
    } else {
      Add(surface, truth.surface);
    }
  }
  std::ranges::stable_sort(truth.path, {}, &TumPose::stamp_ns);
  const auto repeated = std::ranges::unique(truth.path, {}, &TumPose::stamp_ns);
  truth.path.erase(repeated.begin(), repeated.end());
  return truth;
}

std::vector<fs::path> MapTruthFiles(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files = RocksFiles(folders);
  for (const fs::path& folder : folders) files.push_back(SurfaceFile(folder));
  std::erase_if(files, [](const fs::path& file) { return !fs::exists(file); });
  return files;
}

}  // namespace rigmap
