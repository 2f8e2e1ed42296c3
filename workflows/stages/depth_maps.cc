#include "workflows/stages/depth_maps.h"

#include "imaging/depth_images.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/dense_workspace.h"

namespace rigmap {
namespace {

AskedForDepthMaps Ask(const StageContext&, const Dataset&, const PosedPart&, const DepthIndex&,
                      const DepthMapOptions& options) {
  return {options.depth_maps};
}

void WriteDepthMaps(Publication& publication, const StageContext& context,
                    const AskedForDepthMaps& maps, const Dataset& dataset, const PosedPart& part,
                    const DepthIndex& depths) {
  if (!maps.asked) return;
  publication.Folder("depth_maps", [&](const std::filesystem::path& folder) {
    for (std::size_t i = 0; i < depths.files.size(); ++i) {
      const DepthMap map = ReadDepth(depths.files[i].In(context.root), depths.files[i].key);
      if (i == 0) WriteDepthCamera(map, folder);
      WriteDepthImages(map, folder);
    }
  });
  PublishDenseWorkspace(dataset, part, depths, context, publication);
}

}  // namespace

DepthMapsStage DepthMaps() {
  return {.name = "depth_maps",
          .about = "depth and its sigma as images and as a workspace of COLMAP, if asked for",
          .code = CodeHere(),
          .make = Ask,
          .publishes = {"depth_maps", "dense_workspace"},
          .publish = WriteDepthMaps};
}

}  // namespace rigmap
