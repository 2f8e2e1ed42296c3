#include "workflows/stages/scale.h"

#include <algorithm>

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

AlignedKeyframes MakeScale(const StageContext&, const Odometry& odometry,
                           const KeyframeGraph& graph, const MeasuredModels& measured) {
  if (measured.mapped.method == MappingMethod::kNone) return {};
  return AlignModels(measured.mapped.models, measured.scales, OdometricPoses(odometry, graph));
}

// The first model's factor; spread and counts over all models.
Report DescribeScale(const AlignedKeyframes& aligned) {
  if (aligned.models.empty()) return Report::object();
  double spread = 0.0;
  std::size_t used = 0;
  std::vector<int> rejected;
  for (const AlignedModel& model : aligned.models) {
    spread = std::max(spread, model.scale.relative_spread);
    used += model.scale.pairs_used.size();
    rejected.insert(rejected.end(), model.scale.pairs_rejected.begin(),
                    model.scale.pairs_rejected.end());
  }
  return {{"metres_per_model_unit", aligned.models.front().scale.metres_per_model_unit},
          {"relative_spread", spread},
          {"pairs_used", used},
          {"pairs_rejected", rejected}};
}

Report ReportScale(const AlignedKeyframes& aligned, const Odometry&, const KeyframeGraph&,
                   const MeasuredModels&) {
  return ReportAligned(aligned);
}

}  // namespace

Report ReportAligned(const AlignedKeyframes& aligned) {
  const auto registered = std::ranges::count_if(aligned.world_from_left,
                                                [](const auto& pose) { return pose.has_value(); });
  return {{"frames", {{"registered", registered}}}, {"scale", DescribeScale(aligned)}};
}

ScaleStage Scale() {
  return {.name = "scale",
          .about = "keyframes in metres",
          .code = CodeHere(),
          .make = MakeScale,
          .report = ReportScale};
}

}  // namespace rigmap
