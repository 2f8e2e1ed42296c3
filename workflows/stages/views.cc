#include "workflows/stages/views.h"

#include "pipeline/code_identity.h"
#include "raster/surface_views.h"

namespace rigmap {
namespace {

const std::vector<std::string> kPictures{"view_top.png", "view_side.png", "view_oblique.png"};

Published MakePictures(const StageContext& context, const PosedPart& part, const FusedMap& map,
                       const Warning& warning, const PictureOptions& options) {
  if (map.points == 0) return {};
  for (const std::string& name : kPictures) context.publication->Path(name);
  WriteSurfaceViews({context.root / "dense.ply", map.voxel_m, warning.text}, part.trajectory,
                    context.root, options);
  return {};
}

}  // namespace

ViewsStage Pictures() {
  return {.name = "views",
          .about = "pictures",
          .code = CodeHere(),
          .make = MakePictures,
          .publishes = kPictures};
}

}  // namespace rigmap
