#include "raster/internal/terrain_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "geometry/tile_index.h"
#include "raster/footprint.h"
#include "raster/internal/nearest_views.h"

namespace rigmap {
namespace {

// Blocks to a side of a tile: some thousand cells, however many there are to a block.
int BlocksOfTile(int side) {
  constexpr int kMostBlocks = 64, kCells = 1024;
  return std::clamp(kCells / side, 1, kMostBlocks);
}

constexpr float kNoGround = std::numeric_limits<float>::quiet_NaN();
constexpr double kRadians = std::numbers::pi / 180.0;

// Cells of a window that may reach beyond the file, NaN there.
std::vector<float> ReadPadded(MapFile& map, const CellFrame& frame, int band,
                              const CellWindow& window) {
  CellWindow inside = window;
  inside.column = std::clamp(window.column, 0, frame.columns);
  inside.row = std::clamp(window.row, 0, frame.rows);
  inside.columns = std::clamp(window.column + window.columns, 0, frame.columns) - inside.column;
  inside.rows = std::clamp(window.row + window.rows, 0, frame.rows) - inside.row;
  std::vector<float> padded(static_cast<std::size_t>(window.columns) * window.rows, kNoGround);
  if (inside.columns <= 0 || inside.rows <= 0) return padded;
  const std::vector<float> values = map.ReadBand(band, inside);
  for (int row = 0; row < inside.rows; ++row) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row) * inside.columns, inside.columns,
                padded.begin() +
                    static_cast<std::ptrdiff_t>(row + inside.row - window.row) * window.columns +
                    (inside.column - window.column));
  }
  return padded;
}

// Blocks from `first` on, of cells that were measured.
GroundBlocks ReadBlocks(MapFile& height, const CellFrame& frame, int side,
                        const CellWindow& blocks) {
  const CellFrame block_frame = BlockFrame(frame, side);
  const CellWindow cells{
      static_cast<int>((block_frame.west + blocks.column) * side - frame.west),
      static_cast<int>(frame.north - ((block_frame.north - blocks.row + 1) * side - 1)),
      blocks.columns * side, blocks.rows * side};
  std::vector<float> heights = ReadPadded(height, frame, 1, cells);
  const std::vector<float> sigmas = ReadPadded(height, frame, 2, cells);
  const std::vector<float> counts = ReadPadded(height, frame, 3, cells);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (!(counts[i] > 0.0F)) heights[i] = kNoGround;
  }
  return BlocksOf(heights, sigmas, cells.columns, side, frame.cell_m);
}

double LevelSigma(const TerrainInputs& inputs, const Eigen::Vector2d& x_in_world) {
  const double level_rad = kRadians * inputs.options.level_sigma_deg;
  if (!inputs.trajectory || inputs.trajectory->empty()) return level_rad;
  const auto nearest =
      std::ranges::min_element(*inputs.trajectory, {}, [&](const TimedPose& pose) -> double {
        return (pose.world_from_left.translation.head<2>() - x_in_world).squaredNorm();
      });
  return std::hypot(level_rad, nearest->sigmas.segment<2>(3).maxCoeff());
}

using GroundBands = std::array<std::vector<float>, 4>;

void Put(const std::optional<FootprintGround>& ground, GroundBands& bands) {
  const auto put = [&](int band, double value) {
    bands[band].push_back(ground ? static_cast<float>(value) : kNoGround);
  };
  const FootprintGround known = ground.value_or(FootprintGround{});
  put(0, known.slope_rad / kRadians);
  put(1, known.roughness_m);
  put(2, known.step_height_m);
  put(3, known.steeper);
}

}  // namespace

int BlockSide(double cell_m, double footprint_m) {
  int side = 1;
  while (2 * side * cell_m <= footprint_m / 8.0 && side < 256) side *= 2;
  return side;
}

CellFrame BlockFrame(const CellFrame& frame, int side) {
  CellFrame blocks{frame.cell_m * side, TileOfCell(frame.west, side), TileOfCell(frame.north, side),
                   0, 0};
  blocks.columns =
      static_cast<int>(TileOfCell(frame.west + frame.columns - 1, side) - blocks.west) + 1;
  blocks.rows = static_cast<int>(blocks.north - TileOfCell(frame.north - frame.rows + 1, side)) + 1;
  return blocks;
}

void WriteTerrain(MapFile& height, const PointCells& cells, int side, const TerrainInputs& inputs,
                  MapFile& ground) {
  const CellFrame& frame = cells.frame();
  const CellFrame block_frame = BlockFrame(frame, side);
  FootprintLimits limits{0.5 * inputs.options.footprint_m, kRadians * inputs.options.max_slope_deg};
  const int margin = static_cast<int>(limits.radius_m / block_frame.cell_m) + kBlocksOfStep;
  const int blocks_of_tile = BlocksOfTile(side);
  for (int row = 0; row < block_frame.rows; row += blocks_of_tile) {
    for (int column = 0; column < block_frame.columns; column += blocks_of_tile) {
      const CellWindow tile{column, row, std::min(blocks_of_tile, block_frame.columns - column),
                            std::min(blocks_of_tile, block_frame.rows - row)};
      const GroundBlocks blocks = ReadBlocks(
          height, frame, side,
          {column - margin, row - margin, tile.columns + 2 * margin, tile.rows + 2 * margin});
      if (std::ranges::all_of(blocks.height_m, [](float z) { return std::isnan(z); })) continue;
      limits.level_sigma_rad = LevelSigma(
          inputs, cells.InWorld((column + tile.columns / 2) * side, (row + tile.rows / 2) * side));
      GroundBands bands;
      for (int r = 0; r < tile.rows; ++r) {
        for (int c = 0; c < tile.columns; ++c) {
          Put(GroundUnder(blocks, c + margin, r + margin, limits), bands);
        }
      }
      for (int band = 0; band < 4; ++band) ground.WriteBand(band + 1, tile, std::move(bands[band]));
    }
  }
}

}  // namespace rigmap
