#include "workflows/stages/evaluation.h"

#include "pipeline/code_identity.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {
namespace {

// evaluation.json; empty if there is nothing to compare with.
std::string MakeMetrics(const StageContext& context, const Dataset& dataset, const Truth& truth,
                        const PosedPart& part, const FusedMap&, const EvaluationOptions& options,
                        const RtkAlignmentOptions& alignment,
                        const RockSegmentationOptions& segmentation,
                        const RockSurveyOptions& survey) {
  const auto map = context.root / "dense.ply";
  Report metrics;
  if (!truth.tum_path.empty()) {
    std::vector<TumPose> estimate;
    for (const TimedPose& pose : part.trajectory) {
      estimate.push_back({pose.stamp_ns, pose.world_from_left});
    }
    metrics = CompareWithTruth(estimate, truth.tum_path, map, options);
  }
  const Report surveyed = CompareWithSurvey({part.trajectory, dataset.rig, truth, map},
                                            {alignment, segmentation, survey});
  if (!surveyed.is_null()) metrics.update(surveyed);
  return metrics.is_null() ? "" : metrics.dump(1) + "\n";
}

void PublishMetrics(Publication& publication, const StageContext&, const std::string& metrics,
                    const Dataset&, const Truth&, const PosedPart&, const FusedMap&) {
  if (metrics.empty()) return;
  publication.File("evaluation.json", [&](std::ostream& stream) { stream << metrics; });
}

}  // namespace

EvaluationStage Evaluation() {
  return {.name = "evaluation",
          .about = "trajectory, map and rocks beside ground truth, satellite fixes and survey",
          .code = CodeHere(),
          .make = MakeMetrics,
          .publishes = {"evaluation.json"},
          .publish = PublishMetrics};
}

}  // namespace rigmap
