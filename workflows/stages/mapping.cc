#include "workflows/stages/mapping.h"

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

MeasuredModels MakeModels(const StageContext& context, const ColmapInstallation& colmap,
                          const Dataset& dataset, const Odometry& odometry,
                          const Correspondences& matches, const KeyframeGraph& graph,
                          const MappingOptions& options, const VerificationOptions& verification,
                          const ScaleOptions& scale) {
  const fs::path models = context.publication->Path("colmap/models");
  const bool too_few = graph.keyframes.size() < kMinMappedKeyframes;
  if (too_few || options.method == MappingMethod::kNone) {
    fs::remove_all(models);
    fs::create_directories(models);
    MappingResult nothing{{}, MappingMethod::kNone, {}};
    if (too_few) nothing.remarks = {"fewer than three keyframes: nothing to map"};
    return {std::move(nothing), {}};
  }
  const GraphWithPoses input{graph, matches, dataset.rig, OdometricPoses(odometry, graph)};
  const ColmapFolder folder{context.root};
  MappingResult mapped = MapKeyframes(
      colmap, input, {folder.Database(), folder.Images(), models, context.scratch, context.log},
      options, context.threads);
  // Poses of the odometry agree with the rig whatever the images say: let these speak.
  if (mapped.method == MappingMethod::kTriangulate) {
    for (SparseModel& model : mapped.models) {
      model = AdjustWithoutRig(model, input.rig, verification.min_inliers, {});
    }
  }
  ModelScales scales = MeasureBaselines(mapped.models, input.rig.Baseline(), scale);
  return {std::move(mapped), std::move(scales)};
}

Report ReportModels(const MeasuredModels& measured, const ColmapInstallation& colmap,
                    const Dataset&, const Odometry&, const Correspondences&, const KeyframeGraph&) {
  const MappingResult& mapped = measured.mapped;
  return {
      {"mapping",
       {{"method", mapped.method ? NameOf(*mapped.method) : "none"}, {"remarks", mapped.remarks}}},
      {"versions", {{"colmap", colmap.version_text}}}};
}

}  // namespace

MappingStage Mapping() {
  return {.name = "mapping",
          .about = "models in COLMAP's gauge, with their left-right distances",
          .code = CodeHere(),
          .make = MakeModels,
          .publishes = {"colmap/models"},
          .report = ReportModels,
          .waits_for_child = true};
}

std::vector<Rigid3> OdometricPoses(const Odometry& odometry, const KeyframeGraph& graph) {
  std::vector<Rigid3> poses;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    poses.push_back(odometry[keyframe.frame].world_from_left);
  }
  return poses;
}

}  // namespace rigmap
