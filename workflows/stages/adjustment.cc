#include "workflows/stages/adjustment.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "pipeline/code_identity.h"
#include "workflows/stages/calibration_output.h"
#include "workflows/stages/part_adjuster.h"
#include "workflows/stages/trajectory.h"
#include "workflows/stages/trajectory_output.h"

namespace rigmap {
namespace {

const std::vector<std::string> kRigOutputs{"calibration.json", "rig_refined.yaml"};

// What an adjustment from the mapped poses rests on beside the images.
struct Mapped {
  PartAdjuster::Poses poses;
  Gates gates;
};

std::string Remark(const Gates& failed, const char* what) {
  return fmt::format("{}; {}", FailureReason(failed), what);
}

Gates Judge(const AdjustedPart& part, const StereoRig& rig, const AdjustmentGateOptions& gates) {
  return JudgeAdjustment({rig, part.odometry, part.adjustment, part.trajectory}, gates);
}

AdjustedPart With(AdjustedPart part, std::string remark) {
  part.remarks.push_back(std::move(remark));
  return part;
}

AdjustedPart Choose(const PartAdjuster& adjuster, const Mapped& mapped, StartingFrom planned,
                    const AdjustedPart& from_odometry, const StereoRig& rig,
                    const AdjustmentGateOptions& gates) {
  if (planned == StartingFrom::kOdometry) return from_odometry;
  if (!AllPassed(mapped.gates)) {
    return With(from_odometry,
                Remark(mapped.gates,
                       "the adjustment started from the odometric poses instead of the mapped "
                       "ones"));
  }
  const Gates of_odometric = Judge(from_odometry, rig, gates);
  const bool is_corrected = from_odometry.adjustment.IsRigCorrected();
  if (is_corrected && AllPassed(of_odometric)) return from_odometry;
  AdjustedPart from_mapped = adjuster.From(mapped.poses);
  const Gates of_mapped = Judge(from_mapped, rig, gates);
  if (AllPassed(of_mapped)) {
    if (!is_corrected) return from_mapped;
    return With(std::move(from_mapped),
                Remark(of_odometric, "adjusting from the mapped poses gave the result instead"));
  }
  if (is_corrected) {
    return With(from_odometry,
                Remark(of_odometric, "adjusting from the mapped poses did not mend it"));
  }
  if (AllPassed(of_odometric)) {
    return With(from_odometry,
                Remark(of_mapped, "adjusting from the odometric poses gave the result instead"));
  }
  return With(std::move(from_mapped),
              Remark(of_mapped, "adjusting from the odometric poses did not mend it"));
}

AdjustedPart MakeAdjusted(const StageContext&, const Dataset& dataset, const DatasetContent&,
                          const FeatureStore& features, const Odometry& odometry,
                          const Correspondences& matches, const KeyframeGraph& graph,
                          const AlignedKeyframes& aligned, const AdjustedPart& from_odometry,
                          const StartingFrom& planned, const FeatureOptions& of_features,
                          const CornerOptions& corners, const MaskOptions& masks,
                          const MatchingOptions& matching, const AdjustmentOptions& options,
                          const OdometryOptions& odometry_options,
                          const DeadReckoningOptions& rover, const FilterOptions& filter,
                          const MappingGateOptions& mapping_gates,
                          const AdjustmentGateOptions& gates) {
  const BridgingOptions bridging{of_features, corners, masks, odometry_options, rover, filter};
  const PartAdjuster adjuster({dataset, features, odometry, matches},
                              {matching, options, bridging});
  const auto shape = ShapeOf(aligned.world_from_left.empty() ? nullptr : &aligned);
  const Mapped mapped{PosesByFrame(aligned, graph, odometry.size()),
                      JudgeMapping(shape, mapping_gates)};
  AdjustedPart part = Choose(adjuster, mapped, planned, from_odometry, dataset.rig, gates);
  for (const std::string& remark : part.remarks) spdlog::warn("{}", remark);
  return part;
}

void PublishRigOf(Publication& publication, const StageContext&, const AdjustedPart& part,
                  const Dataset& dataset, const DatasetContent& content, const FeatureStore&,
                  const Odometry&, const Correspondences&, const KeyframeGraph&,
                  const AlignedKeyframes&, const AdjustedPart&) {
  const Adjustment& adjustment = part.adjustment;
  PublishCalibration(dataset, content, adjustment, publication);
  if (adjustment.IsRigCorrected()) PublishRig(WithFilesOf(dataset, adjustment.rig), publication);
}

void PublishAdjusted(Publication& publication, const StageContext& context,
                     const AdjustedPart& part, const Dataset& dataset,
                     const DatasetContent& content, const FeatureStore& features,
                     const Odometry& odometry, const Correspondences& matches,
                     const KeyframeGraph& graph, const AlignedKeyframes& aligned,
                     const AdjustedPart& from_odometry) {
  PublishPosesAndPoints(part, dataset, publication);
  PublishRigOf(publication, context, part, dataset, content, features, odometry, matches, graph,
               aligned, from_odometry);
}

Report ReportAdjusted(const AdjustedPart& part, const Dataset& dataset, const DatasetContent&,
                      const FeatureStore&, const Odometry&, const Correspondences&,
                      const KeyframeGraph&, const AlignedKeyframes&, const AdjustedPart&) {
  Report report = ReportTrajectory(part.trajectory, part.world_up);
  for (const std::string& remark : part.remarks) report["mapping"]["remarks"].push_back(remark);
  report["rig"] = DescribeRigChange(dataset.rig, part.adjustment);
  return report;
}

}  // namespace

AdjustmentStage RigAdjustment() {
  std::vector<std::string> publishes = PosesAndPointsOutputs();
  publishes.insert(publishes.end(), kRigOutputs.begin(), kRigOutputs.end());
  return {.name = "adjustment",
          .about =
              "the same from the mapped poses, where these pass their gates and the rig was not "
              "corrected; of the two the one that passes its gates; points, sigmas, the trajectory",
          .code = CodeHere(),
          .make = MakeAdjusted,
          .publishes = std::move(publishes),
          .publish = PublishAdjusted,
          .report = ReportAdjusted};
}

void PublishCalibrationOnly(AdjustmentStage& stage) {
  stage.publishes = kRigOutputs;
  stage.publish = PublishRigOf;
}

}  // namespace rigmap
