// The stage `raster`: leaves height.tif and ortho.tif, if the map has any point.
#pragma once

#include "pipeline/published.h"
#include "raster/raster_options.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"

namespace rigmap {

using RasterStage = Stage<Published, Takes<FusedMap, Warning>, Reads<RasterOptions>>;
RasterStage Rasters();

}  // namespace rigmap
