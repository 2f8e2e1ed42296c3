#include "evaluation/map_truth.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "export/ply_rows.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr float kNormalUnit = 127.0F;  // the length that unit normals have in the file

fs::path SurfaceFile(const fs::path& folder) { return folder / "surface.ply"; }
fs::path RocksFile(const fs::path& folder) { return folder / ".." / "rocks.json"; }

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

std::optional<MapTruth> ReadMapTruth(const fs::path& folder) {
  const fs::path surface = SurfaceFile(folder);
  if (!fs::exists(surface)) return std::nullopt;
  MapTruth truth;
  truth.path = ReadTum(folder / "trajectory.tum");
  truth.rocks = ReadRocks(RocksFile(folder));
  truth.surface = ReadSurface(surface, !truth.rocks.empty());
  return truth;
}

std::vector<fs::path> MapTruthFiles(const fs::path& folder) {
  std::vector<fs::path> files{SurfaceFile(folder), RocksFile(folder)};
  std::erase_if(files, [](const fs::path& file) { return !fs::exists(file); });
  return files;
}

}  // namespace rigmap
