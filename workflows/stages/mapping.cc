#include "workflows/stages/mapping.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

struct Mapper {
  const StageContext& context;
  const ColmapInstallation& colmap;
  const GraphWithPoses& input;
  const MappingOptions& options;
  const VerificationOptions& verification;
  const ScaleOptions& scale;
  const MappingGateOptions& gates;

  MeasuredModels Map(MappingMethod method, const fs::path& models) const {
    const ColmapFolder folder{context.root};
    MappingOptions how = options;
    how.method = method;
    MappingResult mapped = MapKeyframes(
        colmap, input, {folder.Database(), folder.Images(), models, context.scratch, context.log},
        how, context.threads);
    // Poses of the odometry agree with the rig whatever the images say: let these speak.
    if (mapped.method == MappingMethod::kTriangulate) {
      for (SparseModel& model : mapped.models) {
        model = AdjustWithoutRig(model, input.rig, verification.min_inliers, {});
      }
    }
    ModelScales scales = MeasureBaselines(mapped.models, input.rig.Baseline(), scale);
    return {std::move(mapped), std::move(scales)};
  }

  Gates Judge(const MeasuredModels& measured) const {
    std::vector<BaselineScale> scales;
    for (const auto& known : measured.scales) {
      if (known) scales.push_back(*known);
    }
    return JudgeMapping(ShapeOf(scales, CountPosed(measured.mapped.models, measured.scales),
                                input.graph.keyframes.size()),
                        gates);
  }
};

MeasuredModels MapInTurn(const Mapper& mapper, const InTurn<MappingMethod>& ways,
                         const fs::path& models) {
  MeasuredModels first = mapper.Map(ways.planned, models);
  const Gates gates = mapper.Judge(first);
  if (first.mapped.method != MappingMethod::kSeeded || ways.otherwise == ways.planned ||
      AllPassed(gates)) {
    return first;
  }
  const std::string reason = FailureReason(gates);
  spdlog::warn("{}; triangulating the odometric poses instead", reason);
  const fs::path aside = mapper.context.scratch / "other-models";
  MeasuredModels second = mapper.Map(ways.otherwise, aside);
  if (!AllPassed(mapper.Judge(second))) {
    first.mapped.remarks.push_back(
        fmt::format("{}; triangulating the odometric poses instead did not mend it", reason));
    return first;
  }
  fs::remove_all(models);
  fs::rename(aside, models);
  second.mapped.remarks.push_back(
      fmt::format("{}, so the odometric poses were triangulated instead", reason));
  return second;
}

MeasuredModels MakeModels(const StageContext& context, const ColmapInstallation& colmap,
                          const Dataset& dataset, const Odometry& odometry,
                          const Correspondences& matches, const KeyframeGraph& graph,
                          const InTurn<MappingMethod>& ways, const MappingOptions& options,
                          const VerificationOptions& verification, const ScaleOptions& scale,
                          const MappingGateOptions& gates) {
  const fs::path models = context.publication->Path("colmap/models");
  const bool too_few = graph.keyframes.size() < kMinMappedKeyframes;
  if (too_few || ways.planned == MappingMethod::kNone) {
    fs::remove_all(models);
    fs::create_directories(models);
    MappingResult nothing{{}, MappingMethod::kNone, {}};
    if (too_few) nothing.remarks = {"fewer than three keyframes: nothing to map"};
    return {std::move(nothing), {}};
  }
  const GraphWithPoses input{graph, matches, dataset.rig, OdometricPoses(odometry, graph)};
  return MapInTurn({context, colmap, input, options, verification, scale, gates}, ways, models);
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
