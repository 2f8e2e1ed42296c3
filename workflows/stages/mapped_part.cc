#include "workflows/stages/mapped_part.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/code_identity.h"
#include "scale/metric_models.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {
namespace {

AdjustedPart MakeMapped(const StageContext&, const Dataset& dataset, const Odometry& odometry,
                        const KeyframeGraph& graph, const MeasuredModels& measured,
                        const AlignedKeyframes& aligned, const MappingOptions& options) {
  if (measured.mapped.method != options.method) {
    const auto& remarks = measured.mapped.remarks;
    throw DataError(fmt::format("expected a model of COLMAP's mapping ({}), found none{}",
                                NameOf(options.method),
                                remarks.empty() ? "" : ": " + remarks.front()));
  }
  std::vector<int> frames;
  for (const GraphKeyframe& keyframe : graph.keyframes) frames.push_back(keyframe.frame);
  return LayInWorld(dataset, odometry,
                    InMetres(measured.mapped.models, aligned, frames,
                             static_cast<int>(odometry.size()), dataset.rig));
}

void PublishMapped(Publication& publication, const StageContext&, const AdjustedPart& part,
                   const Dataset& dataset, const Odometry&, const KeyframeGraph&,
                   const MeasuredModels&, const AlignedKeyframes&) {
  PublishPosesAndPoints(part, dataset, publication);
}

Report ReportMapped(const AdjustedPart& part, const Dataset&, const Odometry&, const KeyframeGraph&,
                    const MeasuredModels&, const AlignedKeyframes&) {
  return ReportTrajectory(part.trajectory, part.world_up);
}

}  // namespace

MappedPartStage MappedTrajectory() {
  return {.name = "trajectory",
          .about =
              "COLMAP's poses times the baseline, frames between them by the odometry; no "
              "sigmas",
          .code = CodeHere(),
          .make = MakeMapped,
          .publishes = PosesAndPointsOutputs(),
          .publish = PublishMapped,
          .report = ReportMapped};
}

}  // namespace rigmap
