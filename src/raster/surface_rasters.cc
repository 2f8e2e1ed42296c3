#include "raster/surface_rasters.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/error.h"
#include "raster/fill_pinholes.h"
#include "raster/geotiff.h"
#include "raster/internal/nearest_views.h"
#include "raster/internal/point_bins.h"
#include "raster/internal/terrain_tiles.h"

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
  UpperSurface surface(side, side, layer_m, true);
  bins.ForEach(tile_column, tile_row, [&](std::span<const BinnedPoint> points) {
    for (const BinnedPoint& point : points) {
      surface.Raise(point.column, point.row, point.sample);
    }
  });
  bins.ForEach(tile_column, tile_row, [&](std::span<const BinnedPoint> points) {
    for (const BinnedPoint& point : points) {
      surface.Blend(point.column, point.row, point.sample);
    }
  });
  return surface.Finish();
}

// World's heights to those above the ellipsoid. The grid's first cell is `column`, `row`.
void RaiseToEllipsoid(const GridFrame& earth, const PointCells& cells, int column, int row,
                      SurfaceGrid& grid) {
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (!grid.Holds(c, r)) continue;
      float& height_m = grid.height_m[grid.Index(c, r)];
      Eigen::Vector3d x_in_world;
      x_in_world << cells.InWorld(column + c, row + r), height_m;
      height_m = static_cast<float>(earth.GridFromWorld(x_in_world).z());
    }
  }
}

void WriteTiles(PointBins& bins, const PointCells& cells, int max_hole_cells,
                const RasterInputs& inputs, const std::array<MapFile*, 2>& maps) {
  const CellFrame& frame = cells.frame();
  for (int row = 0; row < frame.TilesDown(); ++row) {
    for (int column = 0; column < frame.TilesAcross(); ++column) {
      if (!bins.HasPoints(column, row)) continue;
      SurfaceGrid grid = TileSurface(bins, column, row, frame.cell_m);
      FillPinholes(grid, max_hole_cells);
      const int first_column = column * CellFrame::kTileCells - bins.margin();
      const int first_row = row * CellFrame::kTileCells - bins.margin();
      if (inputs.trajectory && inputs.left_camera) {
        AddViewAngles({*inputs.trajectory, *inputs.left_camera}, cells, first_column, first_row,
                      grid);
      } else {
        for (CellQuality& quality : grid.quality) quality.view_deg = std::nanf("");
      }
      if (inputs.grid) RaiseToEllipsoid(*inputs.grid, cells, first_column, first_row, grid);
      for (MapFile* map : maps) map->WriteTile(column, row, grid, bins.margin());
    }
  }
}

void RequireFootprint(const FootprintOptions& terrain) {
  RequireOption(terrain.footprint_m > 0.0, "raster.footprint_m", "more than 0",
                terrain.footprint_m);
}

MapNotes TerrainNotes(const MapNotes& notes, const FootprintOptions& terrain,
                      const std::string& up) {
  MapNotes of_terrain = notes;
  of_terrain.items = {{"RIGMAP_FOOTPRINT_M", fmt::format("{}", terrain.footprint_m)},
                      {"RIGMAP_MAX_SLOPE_DEG", fmt::format("{}", terrain.max_slope_deg)}};
  if (!up.empty()) of_terrain.items.emplace_back("RIGMAP_UP", up);
  return of_terrain;
}

}  // namespace

void WriteSurfaceRasters(const GriddedCloud& cloud, const fs::path& folder,
                         const RasterOptions& options, const FootprintOptions& terrain,
                         const RasterInputs& inputs) {
  cloud.Validate();
  RequireValid(options);
  RequireValid(terrain);
  RequireFootprint(terrain);
  const PointCells cells(FrameOf(cloud, inputs.grid), inputs.grid);
  const CellFrame& frame = cells.frame();
  const ScratchFolder scratch(folder / "rasters.unfinished");
  const GdalSession session;
  PointBins bins(cells, FillReach(options.max_hole_cells), scratch.File("points"));
  FillBins(cloud, bins);
  const MapNotes notes{inputs.grid ? inputs.grid->epsg : 0, cloud.warning};
  MapFile height(scratch.File("height"), MapLayer::kHeight, frame, notes);
  MapFile ortho(scratch.File("ortho"), MapLayer::kColour, frame, notes);
  WriteTiles(bins, cells, options.max_hole_cells, inputs, {&height, &ortho});
  const int side = BlockSide(frame.cell_m, terrain.footprint_m);
  MapFile ground(scratch.File("terrain"), MapLayer::kTerrain, BlockFrame(frame, side),
                 TerrainNotes(notes, terrain, inputs.up));
  WriteTerrain(height, cells, side, {terrain, inputs.trajectory}, ground);
  height.SaveCloudOptimised(scratch.File("height.tif"));
  ortho.SaveCloudOptimised(scratch.File("ortho.tif"));
  ground.SaveCloudOptimised(scratch.File("terrain.tif"));
  for (const char* name : {"height.tif", "ortho.tif", "terrain.tif"}) {
    Publish(scratch.File(name), folder / name);
  }
}

}  // namespace rigmap
