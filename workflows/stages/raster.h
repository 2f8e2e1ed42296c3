// The stage `raster`: leaves height.tif, ortho.tif and terrain.tif, if the map has any point.
#pragma once

#include "pipeline/published.h"
#include "raster/raster_options.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/georeference.h"

namespace rigmap {

// With footprint_m as it is asked for, else by the rig's wheels, else 1 m.
TerrainOptions TerrainOf(const StereoRig& rig, TerrainOptions options);

using RasterStage = Stage<Published, Takes<PosedPart, FusedMap, Warning, Georeferenced>,
                          Reads<RasterOptions, TerrainOptions>>;
RasterStage Rasters();

}  // namespace rigmap
