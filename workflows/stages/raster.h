// The stage `raster`: leaves height.tif and ortho.tif, if the map has any point.
#pragma once

#include "raster/raster_options.h"
#include "scene/voxel_options.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"

namespace rigmap {

// Nothing but what it published.
struct Published {
  template <class Archive>
  void serialize(Archive&) {}
};

using RasterStage = Stage<Published, Takes<FusedMap, Warning>, Reads<RasterOptions, VoxelOptions>>;
RasterStage Rasters();

}  // namespace rigmap
