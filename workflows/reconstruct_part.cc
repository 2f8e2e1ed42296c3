#include "workflows/reconstruct_part.h"

#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "colmap/database.h"
#include "dataset/open_dataset.h"
#include "export/tum.h"
#include "workflows/evaluate_part.h"
#include "workflows/part_stages.h"
#include "workflows/part_summary.h"

namespace rigmap {
namespace {

// What data a result folder belongs to: the folder of the first image.
std::string DatasetIdentity(const Dataset& dataset) {
  return std::filesystem::path(dataset.frames.front().left_path).parent_path().string();
}

// The whole method, in two halves. Each stage turns what is before it into one product, keeps it,
// skips the work if an earlier run did it, and publishes what users read (part_stages.h says what).

// Images -> poses. Matches and models are let go here, since the other half needs the memory.
AdjustedPart Localise(const Dataset& dataset, const FeatureIndex& features,
                      const PartStages& stage) {
  // keypoints with stereo partners -> metric motion from frame to keyframe
  const Odometry odometry = stage.Track(dataset, features);

  // verified correspondences -> COLMAP's database -> poses in COLMAP's gauge -> metres
  const Correspondences matches = stage.Match(dataset, features, odometry);
  const KeyframeGraph graph = stage.WriteGraph(dataset, odometry, matches);
  const MappingResult models = stage.Map(dataset, odometry, matches, graph);
  const PlacedKeyframes placed = stage.Scale(dataset, odometry, graph, models);

  // one pose per frame, the rig held -> trajectory and sparse model
  return stage.Adjust(dataset, features, odometry, matches, graph, placed);
}

void Reconstruct(const Dataset& dataset, const PartStages& stage) {
  stage.TakeUp(dataset);
  const FeatureIndex features = stage.Extract(dataset);
  const AdjustedPart part = Localise(dataset, features, stage);

  // depth of the keyframes, fused on the poses -> coloured map
  const DepthIndex depths = stage.MatchDense(dataset, features, part);
  stage.Fuse(dataset, part, depths);
  stage.Evaluate(dataset, part);
}

// The dataset with the truth that it is to be compared with: a TUM file that can be read. Known to
// be wrong now, not when all work is done.
Dataset OpenWithTruth(const PartRequest& request) {
  Dataset dataset = OpenDataset(request.dataset);
  if (request.truth) {
    dataset.truth_path = std::filesystem::absolute(TruthFile(*request.truth)).string();
  }
  if (!dataset.truth_path.empty()) ReadTum(dataset.truth_path);
  return dataset;
}

ColmapInstallation FindColmapIfNeeded(const PartRequest& request, PartSummary& summary) {
  if (request.until && ComesBefore(*request.until, "database")) return {};
  ColmapInstallation colmap = FindColmap();
  colmap.patience_s = request.options.colmap.patience_s;
  summary.SetColmapVersion(colmap.version_text);
  return colmap;
}

// The reason of a failure matters more than a summary that cannot be written.
void TryToWrite(const PartSummary& summary, const StageRunner& run) {
  try {
    summary.Write(run);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
}

}  // namespace

PartResult ReconstructPart(const PartRequest& request) {
  const tbb::global_control parallelism(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(request.threads));
  cv::setNumThreads(1);  // the work is split over frames
  const Dataset dataset = OpenWithTruth(request);
  const OutputLayout layout{std::filesystem::absolute(request.out)};
  RequireInputElsewhere(layout, dataset);
  RequireOwnOutput(layout, DatasetIdentity(dataset), request.force);
  const OutputLock lock(layout.root);
  RequireUnlocked(layout.Database());
  ClaimOutput(layout, DatasetIdentity(dataset), request.force);
  StageRunner run({layout, request.until, request.from, request.quiet});
  PartSummary summary(request);
  try {
    Reconstruct(dataset, PartStages(request, FindColmapIfNeeded(request, summary), run, summary));
  } catch (const StopAfterStage&) {
    // --until: what was published so far is the result.
  } catch (const std::exception& error) {
    summary.Fail(error.what());
    TryToWrite(summary, run);
    throw;
  }
  return summary.Write(run);
}

}  // namespace rigmap
