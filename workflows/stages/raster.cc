#include "workflows/stages/raster.h"

#include "pipeline/code_identity.h"
#include "raster/surface_rasters.h"

namespace rigmap {
namespace {

Published MakeRasters(const StageContext& context, const FusedMap& map, const Warning& warning,
                      const RasterOptions& options) {
  if (map.points == 0) return {};
  for (const char* name : {"height.tif", "ortho.tif"}) context.publication->Path(name);
  WriteSurfaceRasters({context.root / "dense.ply", map.voxel_m, warning.text}, context.root,
                      options);
  return {};
}

}  // namespace

RasterStage Rasters() {
  return {.name = "raster",
          .about = "height and colours from above",
          .code = CodeHere(),
          .make = MakeRasters,
          .publishes = {"height.tif", "ortho.tif"}};
}

}  // namespace rigmap
