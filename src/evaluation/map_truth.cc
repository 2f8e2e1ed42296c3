#include "evaluation/map_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"
#include "evaluation/point_tree.h"
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

// m; what maps are judged by lies within 6 m of the path, and their points' surface a metre
// farther.
constexpr double kReach_m = 8.0;

// Which points are near a path. Asked of a square of a metre once, since points of one come
// together.
class Surroundings {
 public:
  explicit Surroundings(const std::vector<TumPose>& path) : path_(InPlan(path)), tree_(path_) {}

  bool Hold(const Eigen::Vector3f& x) {
    const Square square{std::floor(x.x()), std::floor(x.y())};
    if (square == last_) return last_is_near_;
    const auto [known, is_new] = is_near_.try_emplace(square, false);
    if (is_new) {
      const Eigen::Vector2d middle(square[0] + 0.5, square[1] + 0.5);
      known->second = tree_.Nearest(middle, kReach_m + std::sqrt(0.5)).has_value();
    }
    last_ = square;
    return last_is_near_ = known->second;
  }

 private:
  using Square = std::array<float, 2>;  // its corner, m

  static std::vector<Eigen::Vector2d> InPlan(const std::vector<TumPose>& path) {
    std::vector<Eigen::Vector2d> points;
    for (const TumPose& pose : path) {
      points.emplace_back(pose.world_from_body.translation.head<2>());
    }
    return points;
  }

  std::vector<Eigen::Vector2d> path_;
  PointTree<Eigen::Vector2d> tree_;
  std::map<Square, bool> is_near_;
  std::optional<Square> last_;
  bool last_is_near_ = false;
};

TrueSurface ReadSurface(const fs::path& path, bool kind_needed, Surroundings& surroundings) {
  PlyRows rows(path);
  const auto x = rows.At({"x", "y", "z"}), normal = rows.At({"nx", "ny", "nz"});
  const PlyProperty& visible = rows.At("visible");
  const PlyProperty* kind = kind_needed ? &rows.At("kind") : rows.Find("kind");
  TrueSurface surface;
  for (std::uint64_t i = 0; i < rows.size(); ++i) {
    const char* row = rows.Next();
    const Eigen::Vector3f point = rows.FinitePoint(x);
    if (!surroundings.Hold(point)) continue;
    surface.x_in_truth.push_back(point);
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
  TakeFromJson(path, "JSON with 'rocks', each with size, x, y, z and width", [&] {
    const auto json = nlohmann::json::parse(ReadTextFile(path));
    for (const auto& rock : json.at("rocks")) rocks.push_back(RockFromJson(rock));
  });
  return rocks;
}

}  // namespace

std::optional<MapTruth> ReadMapTruth(const std::vector<fs::path>& folders,
                                     std::vector<TumPose> path) {
  const auto has_surface = [](const fs::path& folder) { return fs::exists(SurfaceFile(folder)); };
  if (folders.empty() || path.empty() || !std::ranges::all_of(folders, has_surface))
    return std::nullopt;
  Surroundings surroundings(path);
  MapTruth truth{.path = std::move(path)};
  for (const fs::path& file : RocksFiles(folders)) {
    std::ranges::move(ReadRocks(file), std::back_inserter(truth.rocks));
  }
  for (const fs::path& folder : folders) {
    TrueSurface surface = ReadSurface(SurfaceFile(folder), !truth.rocks.empty(), surroundings);
    if (folder == folders.front()) {
      truth.surface = std::move(surface);
    } else {
      Add(surface, truth.surface);
    }
  }
  return truth;
}

std::vector<fs::path> MapTruthFiles(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files = RocksFiles(folders);
  for (const fs::path& folder : folders) files.push_back(SurfaceFile(folder));
  std::erase_if(files, [](const fs::path& file) { return !fs::exists(file); });
  return files;
}

}  // namespace rigmap
