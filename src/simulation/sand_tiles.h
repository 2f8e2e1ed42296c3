// The sand as square tiles of height grids: fine near the rover's way, ever coarser farther out.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/ray_scene.h"
#include "simulation/terrain.h"

namespace rigmap {

struct SandTile {
  Eigen::Vector2d corner;  // south-west
  double cell_m = 0.0;
};

// A quadtree of tiles of kCells x kCells cells that covers the outline, 400 m beyond it, and at
// least 1.2 km around the origin. Corners of cells lie on whole multiples of their size.
class SandTiles {
 public:
  static constexpr int kCells = 64;

  // Cells are `cell_m` within `fine_m` of the outline; farther out they grow with the square of the
  // distance, as a view from a metre above the sand foreshortens them.
  SandTiles(std::span<const Eigen::Vector2d> outline, double cell_m, double fine_m);

  const std::vector<SandTile>& tiles() const { return tiles_; }
  // The tile that holds a place; places outside are taken to the nearest edge.
  std::uint32_t TileAt(const Eigen::Vector2d& position) const;

 private:
  struct Node {
    std::uint32_t first_child =
        0;  // of four in a row, south-west, -east, north-west, -east; 0: none
    std::uint32_t tile = 0;
  };
  void Split(std::uint32_t node, const Eigen::Vector2d& corner, double cell_m);
  bool IsFineEnough(const Eigen::Vector2d& corner, double cell_m) const;

  std::span<const Eigen::Vector2d> outline_;  // while building
  double finest_m_, fine_m_, root_cell_m_;
  std::vector<Node> nodes_;
  std::vector<SandTile> tiles_;
};

// Heights at the nodes of all tiles and at kMargin nodes around each, which slopes and hollows
// need.
class SandHeights {
 public:
  static constexpr int kMargin = 5, kSide = SandTiles::kCells + 1 + 2 * kMargin;

  SandHeights(const Terrain& terrain, const SandTiles& tiles);

  // Of a tile: kSide x kSide, south to north, west to east.
  std::span<const float> Of(std::size_t tile) const {
    return std::span(heights_).subspan(tile * kSide * kSide, kSide * kSide);
  }

 private:
  std::vector<float> heights_;
};

// Vertices of all tiles, one grid each in the order of tiles(), with a skirt around each that
// closes the cracks between cells of different size. Grids are (kCells + 3) nodes wide.
struct SandMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<VertexGrid> grids;
};
SandMesh MeshTiles(const SandTiles& tiles, const SandHeights& heights);

}  // namespace rigmap
