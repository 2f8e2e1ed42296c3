#include "workflows/stages/evaluation.h"

#include "pipeline/code_identity.h"
#include "workflows/stages/compare_result.h"
#include "workflows/stages/reference_output.h"

namespace rigmap {
namespace {

std::vector<TumPose> PosesOf(const Trajectory& trajectory) {
  std::vector<TumPose> poses;
  for (const TimedPose& pose : trajectory) poses.push_back({pose.stamp_ns, pose.world_from_left});
  return poses;
}

std::string TextOf(const Report& report) { return report.is_null() ? "" : report.dump(1) + "\n"; }

EvaluationTexts MakeMetrics(const StageContext& context, const Dataset& dataset, const Truth& truth,
                            const PosedPart& part, const Steps& steps, const FusedMap&,
                            const EvaluationOptions& options, const RtkAlignmentOptions& alignment,
                            const RockSegmentationOptions& segmentation,
                            const RockSurveyOptions& survey) {
  const auto map = context.root / "dense.ply";
  Report metrics;
  if (!truth.path.empty()) {
    metrics = CompareWithTruth(PosesOf(part.trajectory), truth.path, map, options);
    WarnOfTruth(metrics, truth.path);
  }
  for (const Step& step : steps) {
    Report of_step;
    if (!truth.path.empty()) {
      of_step = CompareWithTruth(PosesOf(step.trajectory), truth.path, {}, options);
    }
    const Report rtk = CompareWithFixes(step.trajectory, dataset.rig, truth.fixes, alignment);
    if (!rtk.is_null()) of_step["rtk"] = rtk;
    if (!of_step.is_null()) metrics["steps"][step.name] = of_step;
  }
  const SurveyedResult result{part.trajectory, dataset.rig, truth, map};
  const Report surveyed = CompareWithSurvey(result, {alignment, segmentation, survey});
  if (!surveyed.is_null()) metrics.update(surveyed);
  return {TextOf(metrics), TextOf(DescribeReference(result, metrics, options, alignment))};
}

void PublishMetrics(Publication& publication, const StageContext&, const EvaluationTexts& texts,
                    const Dataset&, const Truth&, const PosedPart&, const Steps&, const FusedMap&) {
  const auto publish = [&](const char* name, const std::string& text) {
    if (!text.empty()) publication.File(name, [&](std::ostream& stream) { stream << text; });
  };
  publish("evaluation.json", texts.metrics);
  publish("reference.json", texts.reference);
}

}  // namespace

EvaluationStage Evaluation() {
  return {.name = "evaluation",
          .about = "trajectory, map and rocks beside ground truth, satellite fixes and survey",
          .code = CodeHere(),
          .make = MakeMetrics,
          .publishes = {"evaluation.json", "reference.json"},
          .publish = PublishMetrics};
}

}  // namespace rigmap
