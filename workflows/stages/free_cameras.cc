#include "workflows/stages/free_cameras.h"

#include <fmt/format.h>

#include <numeric>

#include "core/error.h"
#include "pipeline/code_identity.h"
#include "scale/free_camera_poses.h"
#include "scale/metric_models.h"
#include "trajectory/interpolated_odometry.h"
#include "workflows/stages/scale.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {
namespace {

FreeCameraPaths PathsOf(const StageContext& context) {
  const ColmapFolder folder{context.root};
  return {folder.Database(), folder.Images(), context.scratch, context.log};
}

FreeMatches MakeFreeMatches(const StageContext& context, const ColmapInstallation& colmap,
                            const Dataset& dataset, const DatasetContent&,
                            const FreeMatchingOptions& options) {
  FreeCameraPaths paths = PathsOf(context);
  LinkImages(dataset, context.publication->Path("colmap/images"));
  // COLMAP writes into it for a long time: it gets its name when it is whole.
  std::filesystem::create_directories(context.scratch);
  paths.database = context.scratch / "database.db";
  const std::size_t pairs = MatchFreeCameras(colmap, dataset, paths, options, context.threads);
  std::filesystem::rename(paths.database, context.publication->Path("colmap/database.db"));
  return {pairs};
}

MappingResult MakeFreeModels(const StageContext& context, const ColmapInstallation& colmap,
                             const Dataset& dataset, const FreeMatches&,
                             const FreeMappingOptions& options) {
  const auto models = context.publication->Path("colmap/models");
  std::filesystem::remove_all(models);
  return MapFreeCameras(colmap, PathsOf(context), models, options, dataset.frames.size(),
                        context.threads);
}

Report ReportFreeModels(const MappingResult& mapped, const ColmapInstallation& colmap,
                        const Dataset&, const FreeMatches&) {
  return {
      {"mapping",
       {{"method", mapped.method ? NameOf(*mapped.method) : "none"}, {"remarks", mapped.remarks}}},
      {"versions", {{"colmap", colmap.version_text}}}};
}

AlignedKeyframes MakeFreeScale(const StageContext&, const Dataset& dataset,
                               const MappingResult& mapped, const ScaleOptions& options) {
  return PoseFreeCameras(mapped.models, static_cast<int>(dataset.frames.size()), dataset.rig,
                         options);
}

Report ReportFreeScale(const AlignedKeyframes& aligned, const Dataset& dataset,
                       const MappingResult& mapped) {
  Report report = ReportAligned(aligned);
  report["frames"]["keyframes"] = dataset.frames.size();
  if (mapped.models.size() > 1) {
    report["mapping"]["remarks"] = {
        fmt::format("COLMAP left {} models that nothing joins: only one of them is used",
                    mapped.models.size())};
  }
  return report;
}

AdjustedPart MakeFreeTrajectory(const StageContext&, const Dataset& dataset,
                                const MappingResult& mapped, const AlignedKeyframes& aligned) {
  if (aligned.models.empty()) {
    throw DataError("structure from motion: " +
                    (mapped.remarks.empty() ? "expected a model with left and right images of a "
                                              "frame, found none that COLMAP made"
                                            : mapped.remarks.front()));
  }
  std::vector<int> frames(dataset.frames.size());
  std::iota(frames.begin(), frames.end(), 0);
  std::vector<StampNs> stamps;
  for (const StereoFrame& frame : dataset.frames) stamps.push_back(frame.stamp_ns);
  return LayInWorld(dataset, InterpolatedOdometry(stamps, aligned.world_from_left),
                    InMetres(mapped.models, aligned, frames,
                             static_cast<int>(dataset.frames.size()), dataset.rig));
}

void PublishFreeTrajectory(Publication& publication, const StageContext&, const AdjustedPart& part,
                           const Dataset& dataset, const MappingResult&, const AlignedKeyframes&) {
  PublishPosesAndPoints(part, dataset, publication);
}

Report ReportFreeTrajectory(const AdjustedPart& part, const Dataset&, const MappingResult&,
                            const AlignedKeyframes&) {
  return ReportTrajectory(part.trajectory, part.world_up);
}

}  // namespace

FreeMatchingStage FreeMatching() {
  return {.name = "database",
          .about = "COLMAP's own features and matches, left and right images on their own",
          .code = CodeHere(),
          .make = MakeFreeMatches,
          .publishes = {"colmap/database.db", "colmap/images"}};
}

FreeMappingStage FreeMapping() {
  return {.name = "mapping",
          .about = "models in COLMAP's gauge, by its own defaults",
          .code = CodeHere(),
          .make = MakeFreeModels,
          .publishes = {"colmap/models"},
          .report = ReportFreeModels};
}

FreeScaleStage FreeScale() {
  return {.name = "scale",
          .about =
              "the largest model in metres by its mean left-right distance, frames at the "
              "midpoint of their cameras",
          .code = CodeHere(),
          .make = MakeFreeScale,
          .report = ReportFreeScale};
}

FreeTrajectoryStage FreeTrajectory() {
  return {.name = "trajectory",
          .about = "these poses laid into the world; frames without one between their neighbours",
          .code = CodeHere(),
          .make = MakeFreeTrajectory,
          .publishes = PosesAndPointsOutputs(),
          .publish = PublishFreeTrajectory,
          .report = ReportFreeTrajectory};
}

}  // namespace rigmap
