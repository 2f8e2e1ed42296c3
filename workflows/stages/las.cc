#include "workflows/stages/las.h"

#include "export/ply_reader.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

Published MakeLas(const StageContext& context, const FusedMap& map, const Warning& warning,
                  const Georeferenced& earth, const LasOptions& options) {
  if (map.points == 0 || !options.las) return {};
  context.publication->File("dense.las", [&](std::ostream& stream) {
    WriteLasOf(context.root / "dense.ply", LasFrameOn(earth.Grid(), warning.text), stream);
  });
  return {};
}

}  // namespace

LasFrame LasFrameOn(const std::optional<GridFrame>& grid, const std::string& warning) {
  LasFrame frame;
  frame.warning = warning;
  if (!grid) return frame;
  frame.epsg = grid->epsg;
  frame.file_from_world = [grid = *grid](const Eigen::Vector3d& x_in_world) {
    return grid.GridFromWorld(x_in_world);
  };
  return frame;
}

void WriteLasOf(const std::filesystem::path& ply, const LasFrame& frame, std::ostream& stream) {
  LasWriter writer(stream, frame);
  PointCloud block;
  for (PlyReader reader(ply); reader.Read(block);) writer.Bound(block);
  for (PlyReader reader(ply); reader.Read(block);) writer.Write(block);
  writer.Finish();
}

LasStage LasFile() {
  return {.name = "las",
          .about = "the cloud as LAS",
          .code = CodeHere(),
          .make = MakeLas,
          .publishes = {"dense.las"}};
}

}  // namespace rigmap
