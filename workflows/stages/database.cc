#include "workflows/stages/database.h"

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

KeyframeGraph MakeGraph(const StageContext&, const ColmapInstallation&, const Dataset& dataset,
                        const Odometry& odometry, const Correspondences& matches,
                        const KeyframeGraphOptions& options) {
  return BuildKeyframeGraph(matches, odometry, dataset, options);
}

void PublishGraph(Publication& publication, const StageContext& context, const KeyframeGraph& graph,
                  const ColmapInstallation& colmap, const Dataset& dataset, const Odometry&,
                  const Correspondences& matches) {
  LinkImages(dataset, publication.Path("colmap/images"));
  WriteDatabase(colmap, MakeDatabaseContent(graph, matches, dataset.rig),
                publication.Path("colmap/database.db"), context.log);
}

}  // namespace

DatabaseStage Database() {
  return {.name = "database",
          .about = "what COLMAP gets, with the known cameras",
          .code = CodeHere(),
          .make = MakeGraph,
          .publishes = {"colmap/database.db", "colmap/images"},
          .publish = PublishGraph};
}

void LinkImages(const Dataset& dataset, const fs::path& images) {
  fs::remove_all(images);
  for (const char* folder : {"left", "right"}) fs::create_directories(images / folder);
  for (const StereoFrame& frame : dataset.frames) {
    for (const Eye eye : kEyes) {
      fs::create_symlink(frame.PathOf(eye), images / ImageName(frame, eye));
    }
  }
}

}  // namespace rigmap
