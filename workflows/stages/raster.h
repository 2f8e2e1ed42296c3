// The stage `raster`: leaves height.tif, ortho.tif and terrain.tif, if the map has any point.
#pragma once

#include "pipeline/published.h"
#include "raster/raster_options.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/georeference.h"

namespace rigmap {

// With footprint_m as it is asked for, else by the rig's wheels, else 1 m.
FootprintOptions TerrainOf(const StereoRig& rig, FootprintOptions options);

using RasterStage = Stage<Published, Takes<PosedPart, FusedMap, Warning, Georeferenced>,
                          Reads<RasterOptions, FootprintOptions>>;
RasterStage Rasters();

}  // namespace rigmap
