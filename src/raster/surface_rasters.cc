#include "raster/surface_rasters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "export/ply_reader.h"
#include "raster/point_bins.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

class ScratchFolder {
 public:
  explicit ScratchFolder(const fs::path& path) : path_(path) {
    std::error_code code;
    fs::remove_all(path, code);
    fs::create_directories(path, code);
    if (code) {
      throw DataError(
          fmt::format("{}: cannot create the folder: {}", path.string(), code.message()));
    }
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  fs::path File(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

void Publish(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::rename(from, to, code);
  if (code) throw DataError(fmt::format("{}: cannot write: {}", to.string(), code.message()));
}

void FillBins(const fs::path& ply, PointBins& bins) {
  PlyReader reader(ply);
  PointCloud block;
  while (reader.Read(block)) {
    for (const SurfacePoint& point : block) {
      if (point.x_in_world.allFinite()) bins.Add(point);
    }
  }
  bins.Flush();
}

// Of the tile with the margin around it.
SurfaceGrid TileSurface(PointBins& bins, int tile_column, int tile_row, double layer_m) {
  const int side = CellFrame::kTileCells + 2 * bins.margin();
  UpperSurface surface(side, side, layer_m);
  bins.ForEach(tile_column, tile_row, [&](std::span<const BinnedPoint> points) {
    for (const BinnedPoint& point : points) surface.Raise(point.column, point.row, point.height_m);
  });
  bins.ForEach(tile_column, tile_row, [&](std::span<const BinnedPoint> points) {
    for (const BinnedPoint& point : points) {
      surface.Blend(point.column, point.row, point.height_m, point.rgb, point.observations);
    }
  });
  return surface.Finish();
}

// Cells of the tile itself in which something was seen.
std::uint64_t SeenCells(const SurfaceGrid& grid, int margin) {
  std::uint64_t count = 0;
  for (int row = margin; row < grid.rows - margin; ++row) {
    for (int column = margin; column < grid.columns - margin; ++column) {
      count += grid.Holds(column, row) ? 1 : 0;
    }
  }
  return count;
}

void WriteTiles(PointBins& bins, int max_hole_cells, MapFile& height, MapFile& ortho,
                RasterSummary& summary) {
  for (int row = 0; row < summary.frame.TilesDown(); ++row) {
    for (int column = 0; column < summary.frame.TilesAcross(); ++column) {
      if (!bins.HasPoints(column, row)) continue;
      SurfaceGrid grid = TileSurface(bins, column, row, summary.frame.cell_m);
      const std::uint64_t measured = SeenCells(grid, bins.margin());
      FillPinholes(grid, max_hole_cells, max_hole_cells);
      summary.measured_cells += measured;
      summary.filled_cells += SeenCells(grid, bins.margin()) - measured;
      height.WriteTile(column, row, grid, bins.margin());
      ortho.WriteTile(column, row, grid, bins.margin());
    }
  }
}

}  // namespace

RasterSummary WriteSurfaceRasters(const GriddedCloud& cloud, const fs::path& folder,
                                  const RasterOptions& options, const Georeference& georeference) {
  cloud.Validate();
  RequireValid(options);
  RasterSummary summary{FrameOf(cloud)};
  const ScratchFolder scratch(folder / "rasters.unfinished");
  const GdalSession session;
  PointBins bins(summary.frame, options.max_hole_cells, scratch.File("points"));
  FillBins(cloud.ply, bins);
  MapFile height(scratch.File("height"), MapLayer::kHeight, summary.frame, georeference);
  MapFile ortho(scratch.File("ortho"), MapLayer::kColour, summary.frame, georeference);
  WriteTiles(bins, options.max_hole_cells, height, ortho, summary);
  height.SaveCloudOptimised(scratch.File("height.tif"));
  ortho.SaveCloudOptimised(scratch.File("ortho.tif"));
  Publish(scratch.File("height.tif"), folder / "height.tif");
  Publish(scratch.File("ortho.tif"), folder / "ortho.tif");
  return summary;
}

}  // namespace rigmap
