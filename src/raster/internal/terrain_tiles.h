// terrain.tif, tile by tile, from the height map in the making.
#pragma once

#include "raster/cell_frame.h"
#include "raster/geotiff.h"
#include "raster/internal/point_cells.h"
#include "raster/raster_options.h"
#include "scene/trajectory.h"

namespace rigmap {

// Cells to a side of a block: the largest power of two that leaves eight blocks across a footprint,
// at least one.
int BlockSide(double cell_m, double footprint_m);

// The blocks that hold a frame's cells; their borders are at multiples of their side.
CellFrame BlockFrame(const CellFrame& frame, int side);

// Kept by reference.
struct TerrainInputs {
  const FootprintOptions& options;
  const Trajectory* trajectory;  // whose sigmas about x and y add to the level's; null: none
};

// Fills `ground`, a file of BlockFrame, from the bands of `height`, a file of the cells' frame.
// Cells that were only filled in do not count.
void WriteTerrain(MapFile& height, const PointCells& cells, int side, const TerrainInputs& inputs,
                  MapFile& ground);

}  // namespace rigmap
