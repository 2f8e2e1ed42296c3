#include "workflows/stages/raster.h"

#include <algorithm>

#include "pipeline/code_identity.h"
#include "raster/surface_rasters.h"

namespace rigmap {
namespace {

const std::vector<std::string> kRasters{"height.tif", "ortho.tif", "terrain.tif"};
constexpr double kUnknownFootprint_m = 1.0;

Published MakeRasters(const StageContext& context, const PosedPart& part, const FusedMap& map,
                      const Warning& warning, const Georeferenced& earth,
                      const RasterOptions& options, const FootprintOptions& terrain) {
  if (map.points == 0) return {};
  for (const std::string& name : kRasters) context.publication->Path(name);
  WriteSurfaceRasters(
      {context.root / "dense.ply", map.voxel_m, warning.text}, context.root, options,
      TerrainOf(part.rig, terrain),
      {&part.trajectory, &part.rig.left.camera, earth.Grid(), std::string(Name(part.world_up))});
  return {};
}

}  // namespace

FootprintOptions TerrainOf(const StereoRig& rig, FootprintOptions options) {
  if (options.footprint_m > 0.0) return options;
  if (rig.wheels) {
    for (const RoverWheel& a : rig.wheels->wheels) {
      for (const RoverWheel& b : rig.wheels->wheels) {
        options.footprint_m =
            std::max(options.footprint_m, (a.contact_in_imu - b.contact_in_imu).norm());
      }
    }
  }
  if (!(options.footprint_m > 0.0)) options.footprint_m = kUnknownFootprint_m;
  return options;
}

RasterStage Rasters() {
  return {.name = "raster",
          .about = "height, colours and the ground under a rover, from above",
          .code = CodeHere(),
          .make = MakeRasters,
          .publishes = kRasters};
}

}  // namespace rigmap
