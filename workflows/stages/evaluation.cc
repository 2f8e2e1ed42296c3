#include "workflows/stages/evaluation.h"

#include "pipeline/code_identity.h"
#include "workflows/stages/compare_result.h"

namespace rigmap {
namespace {

std::vector<TumPose> PosesOf(const Trajectory& trajectory) {
  std::vector<TumPose> poses;
  for (const TimedPose& pose : trajectory) poses.push_back({pose.stamp_ns, pose.world_from_left});
  return poses;
}

// evaluation.json; empty if there is nothing to compare with.
std::string MakeMetrics(const StageContext& context, const Dataset& dataset, const Truth& truth,
                        const PosedPart& part, const Steps& steps, const FusedMap&,
                        const EvaluationOptions& options, const RtkAlignmentOptions& alignment,
                        const RockSegmentationOptions& segmentation,
                        const RockSurveyOptions& survey) {
  const auto map = context.root / "dense.ply";
  Report metrics;
  if (!truth.path.empty()) {
    metrics = CompareWithTruth(PosesOf(part.trajectory), truth.path, map, options);
    for (const Step& step : steps) {
      metrics["steps"][step.name] =
          CompareWithTruth(PosesOf(step.trajectory), truth.path, {}, options);
    }
  }
  const Report surveyed = CompareWithSurvey({part.trajectory, dataset.rig, truth, map},
                                            {alignment, segmentation, survey});
  if (!surveyed.is_null()) metrics.update(surveyed);
  return metrics.is_null() ? "" : metrics.dump(1) + "\n";
}

void PublishMetrics(Publication& publication, const StageContext&, const std::string& metrics,
                    const Dataset&, const Truth&, const PosedPart&, const Steps&, const FusedMap&) {
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
