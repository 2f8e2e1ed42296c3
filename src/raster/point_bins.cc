#include "raster/internal/point_bins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "raster/internal/surface_patch.h"

namespace rigmap {
namespace {

constexpr int kTile = CellFrame::kTileCells;
constexpr std::size_t kMaxWaiting = (std::size_t{32} << 20) / sizeof(BinnedPoint);

}  // namespace

PointBins::PointBins(const PointCells& cells, int margin, const std::filesystem::path& scratch)
    : cells_(cells),
      frame_(cells.frame()),
      margin_(margin),
      scratch_(scratch),
      file_(scratch, std::ios::in | std::ios::out | std::ios::binary | std::ios::trunc),
      chunks_(static_cast<std::size_t>(frame_.TilesAcross()) * frame_.TilesDown()),
      waiting_(chunks_.size()) {
  if (!file_) {
    throw DataError(fmt::format("{}: cannot write: {}", scratch.string(), std::strerror(errno)));
  }
}

std::size_t PointBins::TileIndex(int tile_column, int tile_row) const {
  return static_cast<std::size_t>(tile_row) * frame_.TilesAcross() + tile_column;
}

void PointBins::Add(const SurfacePoint& point) {
  const bool is_coarse = point.IsCoarserThan(frame_.cell_m);
  cells_.ForEach(point, [&](int column, int row) {
    const double height_m =
        is_coarse ? HeightAt(point, cells_.InWorld(column, row)) : point.x_in_world.z();
    AddAt(SampleOf(point, height_m, frame_.cell_m), column, row);
  });
  if (waiting_count_ >= kMaxWaiting) Flush();
}

void PointBins::AddAt(const CellSample& sample, int column, int row) {
  const int first_column = std::max(column - margin_, 0) / kTile;
  const int last_column = std::min((column + margin_) / kTile, frame_.TilesAcross() - 1);
  const int first_row = std::max(row - margin_, 0) / kTile;
  const int last_row = std::min((row + margin_) / kTile, frame_.TilesDown() - 1);
  for (int r = first_row; r <= last_row; ++r) {
    for (int c = first_column; c <= last_column; ++c) {
      waiting_[TileIndex(c, r)].push_back({static_cast<std::uint16_t>(column - c * kTile + margin_),
                                           static_cast<std::uint16_t>(row - r * kTile + margin_),
                                           sample});
      ++waiting_count_;
    }
  }
}

void PointBins::Flush() {
  for (std::size_t tile = 0; tile < waiting_.size(); ++tile) {
    // Taken out, so that its memory goes: the next points may lie in other tiles.
    const auto points = std::exchange(waiting_[tile], {});
    if (points.empty()) continue;
    file_.write(reinterpret_cast<const char*>(points.data()),
                static_cast<std::streamsize>(points.size() * sizeof(BinnedPoint)));
    chunks_[tile].push_back({written_count_, static_cast<std::uint32_t>(points.size())});
    written_count_ += points.size();
  }
  file_.flush();
  waiting_count_ = 0;
  if (!file_) {
    throw DataError(fmt::format("{}: cannot write: {}", scratch_.string(), std::strerror(errno)));
  }
}

bool PointBins::HasPoints(int tile_column, int tile_row) const {
  return !chunks_[TileIndex(tile_column, tile_row)].empty();
}

void PointBins::ForEach(int tile_column, int tile_row,
                        const std::function<void(std::span<const BinnedPoint>)>& take) {
  std::vector<BinnedPoint> points;
  for (const Chunk& chunk : chunks_[TileIndex(tile_column, tile_row)]) {
    points.resize(chunk.count);
    file_.seekg(static_cast<std::streamoff>(chunk.first * sizeof(BinnedPoint)));
    file_.read(reinterpret_cast<char*>(points.data()),
               static_cast<std::streamsize>(points.size() * sizeof(BinnedPoint)));
    if (!file_) throw DataError(fmt::format("{}: cannot read it back", scratch_.string()));
    take(points);
  }
}

}  // namespace rigmap
