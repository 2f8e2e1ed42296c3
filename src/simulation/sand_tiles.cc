#include "simulation/sand_tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kLeastSide_m = 1200.0;
constexpr double kBeyondWay_m = 400.0;  // what lies farther off is a pixel high at most

// Of the square around the origin that holds the way and what is seen from it.
double SideFor(std::span<const Eigen::Vector2d> outline) {
  double farthest_m = 0.0;
  for (const auto& way : outline) farthest_m = std::max(farthest_m, way.cwiseAbs().maxCoeff());
  return std::max(kLeastSide_m, 2.0 * (farthest_m + kBeyondWay_m));
}

}  // namespace

SandTiles::SandTiles(std::span<const Eigen::Vector2d> outline, double cell_m, double fine_m)
    : outline_(outline), finest_m_(cell_m), fine_m_(fine_m), root_cell_m_(cell_m) {
  const double side_m = SideFor(outline);
  while (root_cell_m_ * kCells < side_m) root_cell_m_ *= 2.0;
  nodes_.emplace_back();
  Split(0, Eigen::Vector2d::Constant(-0.5 * kCells * root_cell_m_), root_cell_m_);
  outline_ = {};
}

bool SandTiles::IsFineEnough(const Eigen::Vector2d& corner, double cell_m) const {
  constexpr double kCellsAcrossDistance = 60.0;
  if (cell_m <= 1.001 * finest_m_) return true;
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * kCells * cell_m);
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const auto& way : outline_) {
    const Eigen::Vector2d beyond = ((way - corner - half).cwiseAbs() - half).cwiseMax(0.0);
    nearest2 = std::min(nearest2, beyond.squaredNorm());
  }
  if (nearest2 <= fine_m_ * fine_m_) return false;
  const double allowed_m =
      std::min(finest_m_ * nearest2 / (fine_m_ * fine_m_),
               std::max(finest_m_, std::sqrt(nearest2) / kCellsAcrossDistance));
  return cell_m <= allowed_m;
}

void SandTiles::Split(std::uint32_t node, const Eigen::Vector2d& corner, double cell_m) {
  if (IsFineEnough(corner, cell_m)) {
    nodes_[node].tile = static_cast<std::uint32_t>(tiles_.size());
    tiles_.push_back({corner, cell_m});
    return;
  }
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first_child = first;
  nodes_.resize(nodes_.size() + 4);
  const double side_m = 0.5 * kCells * cell_m;
  for (std::uint32_t i = 0; i < 4; ++i) {
    Split(first + i, corner + side_m * Eigen::Vector2d(i % 2, i / 2), 0.5 * cell_m);
  }
}

std::uint32_t SandTiles::TileAt(const Eigen::Vector2d& position) const {
  Eigen::Vector2d corner = Eigen::Vector2d::Constant(-0.5 * kCells * root_cell_m_);
  double side_m = kCells * root_cell_m_;
  std::uint32_t node = 0;
  while (nodes_[node].first_child != 0) {
    side_m *= 0.5;
    const bool east = position.x() >= corner.x() + side_m,
               north = position.y() >= corner.y() + side_m;
    corner += side_m * Eigen::Vector2d(east, north);
    node = nodes_[node].first_child + (east ? 1 : 0) + (north ? 2 : 0);
  }
  return nodes_[node].tile;
}

SandHeights::SandHeights(const Terrain& terrain, const SandTiles& tiles)
    : heights_(tiles.tiles().size() * kSide * kSide) {
  tbb::parallel_for(std::size_t{0}, tiles.tiles().size(), [&](std::size_t i) {
    const SandTile& tile = tiles.tiles()[i];
    // Whole multiples of the cell, so that neighbours and truth come to the same doubles.
    const auto first_x = std::llround(tile.corner.x() / tile.cell_m) - kMargin,
               first_y = std::llround(tile.corner.y() / tile.cell_m) - kMargin;
    float* height = heights_.data() + i * kSide * kSide;
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        *height++ = static_cast<float>(
            terrain.Height(static_cast<double>(first_x + column) * tile.cell_m,
                           static_cast<double>(first_y + row) * tile.cell_m, tile.cell_m));
      }
    }
  });
}

SandMesh MeshTiles(const SandTiles& tiles, const SandHeights& heights) {
  constexpr int kSide = SandTiles::kCells + 3;
  constexpr std::size_t kVertices = static_cast<std::size_t>(kSide) * kSide;
  const std::size_t count = tiles.tiles().size();
  SandMesh mesh;
  mesh.vertices.resize(count * kVertices);
  mesh.grids.resize(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const SandTile& tile = tiles.tiles()[i];
    const auto tile_heights = heights.Of(i);
    const auto skirt_m = static_cast<float>(3.0 * tile.cell_m + 0.02);
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const int x = std::clamp(column - 1, 0, SandTiles::kCells),
                  y = std::clamp(row - 1, 0, SandTiles::kCells);
        const bool is_skirt = x != column - 1 || y != row - 1;
        const float height = tile_heights[(y + SandHeights::kMargin) * SandHeights::kSide + x +
                                          SandHeights::kMargin];
        mesh.vertices[i * kVertices + row * kSide + column] = {
            static_cast<float>(tile.corner.x() + x * tile.cell_m),
            static_cast<float>(tile.corner.y() + y * tile.cell_m),
            height - (is_skirt ? skirt_m : 0.0f)};
      }
    }
    mesh.grids[i] = {static_cast<std::uint32_t>(i * kVertices), kSide, kSide};
  });
  return mesh;
}

}  // namespace rigmap
