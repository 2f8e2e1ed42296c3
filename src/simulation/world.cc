#include "simulation/world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/internal/debris.h"
#include "simulation/internal/noise.h"
#include "simulation/internal/world_parts.h"

namespace rigmap {
namespace {

constexpr double kEdge_m = 20000.0;  // where the world ends, behind the horizon

LitMesh Merge(std::span<const Mesh> meshes, SurfaceKind kind) {
  LitMesh merged{.kind = kind};
  std::uint32_t piece = 0;
  for (const Mesh& mesh : meshes) {
    merged.mesh.Append(mesh);
    merged.albedo.resize(merged.mesh.vertices.size(), mesh.albedo);
    merged.piece.resize(merged.mesh.vertices.size(), piece++);
  }
  return merged;
}

Mesh Rectangle(const Eigen::AlignedBox2d& box, double height_m, const Eigen::Vector3f& albedo) {
  Mesh mesh;
  for (const auto& [x, y] : {std::pair{box.min().x(), box.min().y()},
                             {box.max().x(), box.min().y()},
                             {box.max().x(), box.max().y()},
                             {box.min().x(), box.max().y()}}) {
    mesh.vertices.push_back(Eigen::Vector3d(x, y, height_m).cast<float>());
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.albedo = albedo;
  return mesh;
}

Mesh Disc(const Eigen::Vector3d& centre, double radius_m, const Eigen::Vector3f& albedo) {
  constexpr std::uint32_t kCorners = 48;
  Mesh mesh;
  mesh.albedo = albedo;
  mesh.vertices.push_back(centre.cast<float>());
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    mesh.vertices.push_back(
        (centre + radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)).cast<float>());
    mesh.triangles.push_back({0, i + 1, (i + 1) % kCorners + 1});
  }
  return mesh;
}

// Places for markers: ahead of the outline and beside it, near enough to be seen well.
std::vector<Eigen::Vector3d> ScatterMarkers(const Terrain& terrain,
                                            std::span<const Eigen::Vector2d> outline, int count,
                                            std::uint64_t seed) {
  std::vector<Eigen::Vector3d> markers;
  HashSequence random(seed, 41);
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(random.Unit() * static_cast<double>(outline.size()));
    const double angle = random.Between(0.0, 2.0 * std::numbers::pi),
                 away_m = random.Between(0.8, 3.5);
    const Eigen::Vector2d position =
        outline[at] + away_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    double highest_m = -1e9;
    for (int step = 0; step < 64; ++step) {
      const double turn = 0.4 * step, out_m = 0.13 * step / 64.0;
      highest_m = std::max(highest_m, terrain.Height(position.x() + out_m * std::cos(turn),
                                                     position.y() + out_m * std::sin(turn)));
    }
    markers.emplace_back(position.x(), position.y(), highest_m + 0.01);
  }
  return markers;
}

std::vector<Mesh> MarkerMeshes(const std::vector<Eigen::Vector3d>& markers) {
  std::vector<Mesh> meshes;
  for (const auto& centre : markers) {
    meshes.push_back(Disc(centre - Eigen::Vector3d(0.0, 0.0, 2e-4), 2.5 * World::kMarkerRadius_m,
                          Eigen::Vector3f::Constant(0.04f)));
    meshes.push_back(Disc(centre, World::kMarkerRadius_m, Eigen::Vector3f::Constant(0.6f)));
  }
  return meshes;
}

std::vector<Mesh> BoulderMeshes(const std::vector<Boulder>& boulders) {
  std::vector<Mesh> meshes;
  for (const Boulder& boulder : boulders) meshes.push_back(boulder.mesh);
  return meshes;
}

// The beach and the sea beyond the sand's mesh.
std::vector<Mesh> FarBeach() {
  return {Rectangle({Eigen::Vector2d(-100.0, -kEdge_m), Eigen::Vector2d(kEdge_m, kEdge_m)}, -0.8,
                    Eigen::Vector3f(0.38f, 0.33f, 0.25f))};
}
std::vector<Mesh> Sea() {
  return {Rectangle({Eigen::Vector2d(-kEdge_m, -kEdge_m), Eigen::Vector2d(-20.0, kEdge_m)},
                    Terrain::kSeaLevel_m, Eigen::Vector3f(0.13f, 0.17f, 0.20f))};
}

// A long way bends far to a side: dunes and the sea are to be beyond it.
SceneOptions ReachingBeyond(std::span<const Eigen::Vector2d> outline, SceneOptions options) {
  constexpr double kBeach_m = 20.0;
  for (const Eigen::Vector2d& at : outline) {
    options.terrain.hinterland_m =
        std::max(options.terrain.hinterland_m, std::abs(at.x()) + kBeach_m);
  }
  return options;
}

}  // namespace

const LitMesh* World::Parts::SolidOf(std::uint32_t geometry) const {
  const auto found = std::ranges::find(solids, geometry, &LitMesh::geometry);
  return found == solids.end() ? nullptr : &*found;
}

SurfaceKind World::Parts::KindOf(const RayHit& hit) const {
  if (hit.geometry != sand_geometry) return SolidOf(hit.geometry)->kind;
  const SandTile& tile = tiles.tiles()[hit.facet];
  const double middle_x = tile.corner.x() + 0.5 * SandTiles::kCells * tile.cell_m;
  if (middle_x > options.terrain.hinterland_m) return SurfaceKind::kDune;
  return tile.cell_m < 1.001 * options.sand_cell_m ? SurfaceKind::kSand : SurfaceKind::kCoarseSand;
}

World::World(const SceneOptions& given, std::span<const Eigen::Vector2d> outline) {
  const SceneOptions options = ReachingBeyond(outline, given);
  Terrain terrain(options.terrain);
  auto boulders = ScatterBoulders(terrain, outline, options.boulders_per_100_m2, options.seed);
  auto debris = StrewDebris(terrain, outline, kFineSand_m, options.debris_per_m2, options.seed);
  auto markers = ScatterMarkers(terrain, outline, options.markers, options.seed);
  parts_.reset(new Parts{.options = options,
                         .terrain = std::move(terrain),
                         .boulders = std::move(boulders),
                         .debris = std::move(debris),
                         .markers = std::move(markers),
                         .tiles = SandTiles(outline, options.sand_cell_m, kFineSand_m)});
  Parts& parts = *parts_;
  const SandHeights heights(parts.terrain, parts.tiles);
  {
    const SandMesh sand = MeshTiles(parts.tiles, heights);
    parts.sand_geometry = parts.scene.AddGrids(sand.vertices, sand.grids);
  }
  parts.solids.push_back(Merge(BoulderMeshes(parts.boulders), SurfaceKind::kRock));
  parts.solids.push_back(Merge(parts.debris, SurfaceKind::kDebris));
  parts.solids.push_back(Merge(MarkerMeshes(parts.markers), SurfaceKind::kMarker));
  parts.solids.push_back(Merge(FarBeach(), SurfaceKind::kCoarseSand));
  parts.solids.push_back(Merge(Sea(), SurfaceKind::kSea));
  std::erase_if(parts.solids, [](const LitMesh& solid) { return solid.mesh.triangles.empty(); });
  for (LitMesh& solid : parts.solids) solid.geometry = parts.scene.AddMesh(solid.mesh);
  parts.scene.Commit();
  const LightSource source{options.SunDirection().cast<float>(), &parts.scene};
  for (LitMesh& solid : parts.solids) solid.light = LightOnMesh(solid.mesh, source);
  parts.material_seed = HashSequence(options.seed, 51).Next();
  parts.sand = std::make_unique<SandStates>(
      parts.tiles, SandStates::Surroundings{heights, parts.boulders, source, parts.material_seed});
}

World::~World() = default;

std::optional<SurfaceHit> World::Cast(const Eigen::Vector3d& origin,
                                      const Eigen::Vector3d& direction) const {
  const auto hit = parts_->scene.Cast({origin.cast<float>(), direction.cast<float>()});
  if (!hit) return std::nullopt;
  Eigen::Vector3d normal = hit->normal.cast<double>().normalized();
  if (normal.dot(direction) > 0.0) normal = -normal;
  return SurfaceHit{hit->distance, origin + hit->distance * direction, normal,
                    parts_->KindOf(*hit)};
}

bool World::IsOccluded(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  constexpr double kEnds_m = 1e-3;
  const double distance_m = (to - from).norm();
  if (distance_m <= 2.0 * kEnds_m) return false;
  const Eigen::Vector3d direction = (to - from) / distance_m;
  return parts_->scene.IsOccluded({from.cast<float>(), direction.cast<float>(),
                                   static_cast<float>(kEnds_m),
                                   static_cast<float>(distance_m - kEnds_m)});
}

const SceneOptions& World::options() const { return parts_->options; }
const Terrain& World::terrain() const { return parts_->terrain; }
const std::vector<Boulder>& World::boulders() const { return parts_->boulders; }
const std::vector<Mesh>& World::debris() const { return parts_->debris; }
const std::vector<Eigen::Vector3d>& World::markers() const { return parts_->markers; }

}  // namespace rigmap
