#include "simulation/surface_shading.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/internal/materials.h"

namespace rigmap {
namespace {

constexpr int kNodes = SandTiles::kCells + 1;
constexpr float kShadowRayLift_m = 0.002f;  // above the surface, where shadow rays start
constexpr float kSunRadius_rad = 0.012f;    // a low sun behind haze
constexpr float kFinelyLit_m = 0.025f;      // cells up to this size get soft shadows

// How far to look for what stands before the sun: as far as a boulder's shadow reaches, or a
// dune's.
float ShadowReach(const Eigen::Vector3f& position, const LightSource& source) {
  constexpr float kTallest_m = 1.8f, kTallestDune_m = 25.0f;
  constexpr float kFarOut_m = 55.0f;  // half of where dunes begin at the nearest
  const bool is_far_out = std::abs(position.x()) > kFarOut_m;
  return (is_far_out ? kTallestDune_m : kTallest_m) / std::max(0.05f, source.sun_direction.z());
}

// Share of the sun seen from a place.
float SunVisible(const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
                 const LightSource& source, bool is_soft) {
  const Eigen::Vector3f origin = position + kShadowRayLift_m * normal;
  const float reach_m = ShadowReach(position, source);
  if (!is_soft) {
    return source.scene->IsOccluded({origin, source.sun_direction, 0.0f, reach_m}) ? 0.0f : 1.0f;
  }
  const Eigen::Vector3f across = source.sun_direction.unitOrthogonal(),
                        up = source.sun_direction.cross(across);
  // Opposite edges first: where they agree, so does what is between.
  constexpr std::array<std::array<float, 2>, 4> kOffsets{
      {{0.35f, 0.85f}, {-0.35f, -0.85f}, {-0.85f, 0.35f}, {0.85f, -0.35f}}};
  int seen = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == 2 && seen != 1) return seen == 0 ? 0.0f : 1.0f;
    const Eigen::Vector3f direction =
        source.sun_direction + kSunRadius_rad * (kOffsets[i][0] * across + kOffsets[i][1] * up);
    seen += source.scene->IsOccluded({origin, direction, 0.0f, reach_m}) ? 0 : 1;
  }
  return 0.25f * static_cast<float>(seen);
}

Light LightAt(const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
              const LightSource& source, bool is_soft) {
  const float cosine = normal.dot(source.sun_direction);
  const float visible = cosine <= 0.0f ? 0.0f : SunVisible(position, normal, source, is_soft);
  return {visible * std::max(cosine, 0.0f), visible, 0.5f * (1.0f + normal.z())};
}

// How much a boulder keeps of the sky from the sand at its foot.
float SkyBesideBoulders(const Eigen::Vector2d& position, std::span<const Boulder* const> boulders) {
  float sky = 1.0f;
  for (const Boulder* boulder : boulders) {
    const double gap_m =
        std::max(0.0, (position - boulder->centre.head<2>()).norm() - 0.42 * boulder->width_m);
    sky *= 1.0f - 0.55f * static_cast<float>(std::exp(-gap_m / (0.4 * boulder->height_m)));
  }
  return sky;
}

// Sky over a node that lies in a hollow: by its depth below the mean of what is around.
float SkyInHollow(std::span<const float> heights, int at, float cell_m) {
  constexpr int kSide = SandHeights::kSide;
  float sky = 1.0f;
  for (const int reach : {2, 5}) {
    const float mean = 0.25f * (heights[at - reach] + heights[at + reach] +
                                heights[at - reach * kSide] + heights[at + reach * kSide]);
    sky -= std::clamp(0.9f * (mean - heights[at]) / (static_cast<float>(reach) * cell_m), -0.08f,
                      0.4f);
  }
  return std::clamp(sky, 0.15f, 1.1f);
}

std::vector<const Boulder*> BouldersNear(const SandTile& tile,
                                         const std::vector<Boulder>& boulders) {
  const double half_m = 0.5 * SandTiles::kCells * tile.cell_m;
  const Eigen::Vector2d middle = tile.corner + Eigen::Vector2d::Constant(half_m);
  std::vector<const Boulder*> near;
  for (const Boulder& boulder : boulders) {
    if ((boulder.centre.head<2>() - middle).norm() < 1.5 * half_m + 3.0 * boulder.width_m) {
      near.push_back(&boulder);
    }
  }
  return near;
}

}  // namespace

std::vector<Light> LightOnMesh(const Mesh& mesh, const LightSource& source) {
  const auto normals = mesh.VertexNormals();
  std::vector<Light> lights(mesh.vertices.size());
  tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t i) {
    lights[i] = LightAt(mesh.vertices[i], normals[i], source, true);
  });
  return lights;
}

SandStates::SandStates(const SandTiles& tiles, const Surroundings& around) : tiles_(tiles) {
  for (int level = 0; level < kLevels; ++level) {
    level_offset_[level] = texels_per_tile_;
    const std::size_t side = (SandTiles::kCells >> level) + 1;
    texels_per_tile_ += side * side;
  }
  texels_.resize(tiles.tiles().size() * texels_per_tile_);
  tbb::parallel_for(std::size_t{0}, tiles.tiles().size(), [&](std::size_t i) {
    auto texels = TexelsOf(i, around);
    AddMeans(texels);
    std::ranges::copy(texels, texels_.begin() + static_cast<std::ptrdiff_t>(i * texels_per_tile_));
  });
}

std::vector<SandStates::Texel> SandStates::TexelsOf(std::size_t index,
                                                    const Surroundings& around) const {
  constexpr int kMargin = SandHeights::kMargin, kSide = SandHeights::kSide;
  const SandTile& tile = tiles_.tiles()[index];
  const auto cell_m = static_cast<float>(tile.cell_m);
  const auto heights = around.heights.Of(index);
  const auto near = BouldersNear(tile, around.boulders);
  std::vector<Texel> texels(texels_per_tile_);
  for (int row = 0; row < kNodes; ++row) {
    for (int column = 0; column < kNodes; ++column) {
      const int at = (row + kMargin) * kSide + column + kMargin;
      const Eigen::Vector2d position = tile.corner + tile.cell_m * Eigen::Vector2d(column, row);
      const Eigen::Vector3f slopes(heights[at - 1] - heights[at + 1],
                                   heights[at - kSide] - heights[at + kSide], 2.0f * cell_m);
      const Eigen::Vector3f surface(static_cast<float>(position.x()),
                                    static_cast<float>(position.y()), heights[at]);
      const Light light =
          LightAt(surface, slopes.normalized(), around.source, cell_m <= kFinelyLit_m);
      const float sky =
          light.sky * SkyInHollow(heights, at, cell_m) * SkyBesideBoulders(position, near);
      texels[row * kNodes + column] = {light.sun, light.visible, sky,
                                       SandTone(position, cell_m, around.seed)};
    }
  }
  return texels;
}

// Each coarser level: a 1-2-1 mean in both directions of every other node.
void SandStates::AddMeans(std::vector<Texel>& texels) const {
  for (int level = 1; level < kLevels; ++level) {
    const int fine_side = (SandTiles::kCells >> (level - 1)) + 1,
              side = (SandTiles::kCells >> level) + 1;
    const Texel* fine = texels.data() + level_offset_[level - 1];
    Texel* coarse = texels.data() + level_offset_[level];
    for (int at = 0; at < side * side; ++at) {
      coarse[at].setZero();
      for (int around = 0; around < 9; ++around) {
        const int dx = around % 3 - 1, dy = around / 3 - 1;
        const int column = std::clamp(2 * (at % side) + dx, 0, fine_side - 1),
                  row = std::clamp(2 * (at / side) + dy, 0, fine_side - 1);
        const float weight = (dx == 0 ? 0.5f : 0.25f) * (dy == 0 ? 0.5f : 0.25f);
        coarse[at] += weight * fine[row * fine_side + column];
      }
    }
  }
}

SandStates::Texel SandStates::Sample(std::uint32_t tile, const Eigen::Vector2d& position,
                                     int level) const {
  const SandTile& sand = tiles_.tiles()[tile];
  const int cells = SandTiles::kCells >> level, side = cells + 1;
  const Eigen::Vector2f at =
      ((position - sand.corner) / (sand.cell_m * (1 << level))).cast<float>();
  const auto limit = static_cast<float>(cells);
  const float x = std::clamp(at.x(), 0.0f, limit), y = std::clamp(at.y(), 0.0f, limit);
  const int column = std::min(static_cast<int>(x), cells - 1),
            row = std::min(static_cast<int>(y), cells - 1);
  const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
  const Texel* south =
      texels_.data() + tile * texels_per_tile_ + level_offset_[level] + row * side + column;
  const Texel* north = south + side;
  const Texel below = south[0] + u * (south[1] - south[0]),
              above = north[0] + u * (north[1] - north[0]);
  return below + v * (above - below);
}

SandState SandStates::At(std::uint32_t tile, const Eigen::Vector2d& position,
                         float extent_m) const {
  const SandTile* sand = &tiles_.tiles()[tile];
  const Eigen::Array2d inside = (position - sand->corner).array();
  if ((inside < 0.0).any() || (inside > SandTiles::kCells * sand->cell_m).any()) {
    tile = tiles_.TileAt(position);
    sand = &tiles_.tiles()[tile];
  }
  // Cells doubled until they are as wide as the extent; between two levels by the share that is
  // left, linear in the width.
  float width = extent_m / static_cast<float>(sand->cell_m);
  int level = 0;
  for (; width >= 2.0f && level < kLevels - 1; ++level) width *= 0.5f;
  const float share = std::clamp(width - 1.0f, 0.0f, 1.0f);
  Texel texel = Sample(tile, position, level);
  if (share > 0.02f && level < kLevels - 1) {
    texel += share * (Sample(tile, position, level + 1) - texel);
  }
  return {{texel.x(), texel.y(), texel.z()}, texel.w()};
}

}  // namespace rigmap
