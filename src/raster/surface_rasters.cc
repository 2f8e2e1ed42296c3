#include "raster/surface_rasters.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/error.h"
#include "raster/internal/point_bins.h"

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

void FillBins(const GriddedCloud& cloud, PointBins& bins) {
  ForEachShown(cloud, [&](const SurfacePoint& point) { bins.Add(point); });
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

void WriteTiles(PointBins& bins, const CellFrame& frame, int max_hole_cells,
                const std::array<MapFile*, 2>& maps) {
  for (int row = 0; row < frame.TilesDown(); ++row) {
    for (int column = 0; column < frame.TilesAcross(); ++column) {
      if (!bins.HasPoints(column, row)) continue;
      SurfaceGrid grid = TileSurface(bins, column, row, frame.cell_m);
      FillPinholes(grid, max_hole_cells, max_hole_cells);
      for (MapFile* map : maps) map->WriteTile(column, row, grid, bins.margin());
    }
  }
}

}  // namespace

void WriteSurfaceRasters(const GriddedCloud& cloud, const fs::path& folder,
                         const RasterOptions& options, const Georeference& georeference) {
  cloud.Validate();
  RequireValid(options);
  const CellFrame frame = FrameOf(cloud);
  const ScratchFolder scratch(folder / "rasters.unfinished");
  const GdalSession session;
  PointBins bins(frame, options.max_hole_cells, scratch.File("points"));
  FillBins(cloud, bins);
  MapFile height(scratch.File("height"), MapLayer::kHeight, frame, georeference, cloud.warning);
  MapFile ortho(scratch.File("ortho"), MapLayer::kColour, frame, georeference, cloud.warning);
  WriteTiles(bins, frame, options.max_hole_cells, {&height, &ortho});
  height.SaveCloudOptimised(scratch.File("height.tif"));
  ortho.SaveCloudOptimised(scratch.File("ortho.tif"));
  Publish(scratch.File("height.tif"), folder / "height.tif");
  Publish(scratch.File("ortho.tif"), folder / "ortho.tif");
}

}  // namespace rigmap
