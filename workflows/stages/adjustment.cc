#include "workflows/stages/adjustment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <ranges>
#include <utility>

#include "adjustment/carry_groups.h"
#include "matching/loop_closures_by_rig.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "pipeline/code_identity.h"
#include "pose_graph/relax_poses.h"
#include "trajectory/starting_poses.h"
#include "trajectory/weak_links.h"
#include "workflows/stages/calibration_output.h"
#include "workflows/stages/odometry.h"
#include "workflows/stages/trajectory.h"
#include "workflows/stages/trajectory_output.h"

namespace rigmap {
namespace {

using Poses = std::vector<std::optional<Rigid3>>;  // world_from_left

const std::vector<std::string> kRigOutputs{"calibration.json", "rig_refined.yaml"};

std::vector<int> ReferencesOf(const Odometry& steps) {
  std::vector<int> references;
  for (const OdometryFrame& frame : steps) references.push_back(frame.reference);
  return references;
}

// Those that go across none of these frames, which rise.
std::vector<LoopClosure> ClosuresWithin(const std::vector<int>& apart,
                                        std::vector<LoopClosure> loop_closures) {
  const auto side = [&](int frame) { return std::ranges::upper_bound(apart, frame); };
  std::erase_if(loop_closures, [&](const auto& c) { return side(c.a) != side(c.b); });
  return loop_closures;
}

std::string DescribeContradicted(const std::vector<LoopClosure>& loop_closures) {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> pairs;
  for (const LoopClosure& c : loop_closures | std::views::take(kNamed)) {
    pairs.push_back(fmt::format("{} and {}", c.a, c.b));
  }
  const std::size_t others = loop_closures.size() - pairs.size();
  return fmt::format(
      "loop closures between frames {}{}: all else contradicts them, they are not believed",
      fmt::join(pairs, ", "), others > 0 ? fmt::format(" and {} others", others) : "");
}

std::size_t GroupCount(const Adjustment& adjustment) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < adjustment.datum_frames.size(); ++i) {
    count += adjustment.world_from_left[i] && adjustment.datum_frames[i] == static_cast<int>(i);
  }
  return count;
}

struct Adjuster {
  const Dataset& dataset;
  const FeatureStore& features;
  const Odometry& odometry;
  const Correspondences& matches;
  Poses mapped;  // of the frames that COLMAP posed
  Gates of_mapping;
  const MatchingOptions& matching;
  const AdjustmentOptions& options;
  const BridgingOptions& bridging;
  const AdjustmentGateOptions& gates;

  AdjustedPart From(StartingFrom from) const {
    AdjustedPart part = From(from == StartingFrom::kMapping ? mapped : Poses(), matches,
                             {odometry, matches.loop_closures}, nullptr);
    return part.adjustment.IsRigCorrected() ? WithItsRig(part) : part;
  }

  // What it is to start from: the other way than planned where that is no map to start from.
  StartingFrom Start(const InTurn<StartingFrom>& ways) const {
    const bool is_mapped = ways.planned == StartingFrom::kMapping;
    return is_mapped && !AllPassed(of_mapping) ? ways.otherwise : ways.planned;
  }

  Gates Judge(const AdjustedPart& part) const {
    return JudgeAdjustment({dataset.rig, part.odometry, part.adjustment, part.trajectory}, gates);
  }

 private:
  // As one rig measures them.
  struct Motions {
    Odometry steps;
    std::vector<LoopClosure> loop_closures;
  };

  // Adjusted from these poses, which carry each side of the frames `apart` along.
  struct Sides {
    Poses starting;
    std::vector<int> apart;
    Adjustment adjustment;
  };

  // With the rig that `part` has found to be the right one. Matches had to agree with the other:
  // where that moves a pixel by more than their noise only some did, and those that by chance
  // agree.
  AdjustedPart WithItsRig(const AdjustedPart& part) const {
    const bool matches_anew = part.adjustment.correction_px > matching.keypoint_noise_px;
    const StereoRig& rig = part.adjustment.rig;
    Odometry steps = StepsWith(part);
    std::optional<Correspondences> anew;
    if (matches_anew) anew = MatchFrames(steps, features.AsSource(), rig, matching);
    auto loop_closures = anew ? anew->loop_closures : LoopClosuresByRig(matches, rig, matching);
    AdjustedPart measured_anew = From(
        {}, anew ? *anew : matches, {std::move(steps), std::move(loop_closures)}, &part.adjustment);
    measured_anew.remarks.push_back(fmt::format(
        "the images contradict the calibration: the rig was corrected (rig_refined.yaml), {} anew "
        "with it",
        matches_anew ? "odometry and matching done" : "the odometry done"));
    return measured_anew;
  }

  // A corrected rig is provisional but where it starts from that of an adjustment before.
  AdjustedPart From(const Poses& start, const Correspondences& correspondences, Motions motions,
                    const Adjustment* before) const {
    const auto adjusted = [&](Poses starting, std::vector<int> apart) {
      Sides sides{std::move(starting), std::move(apart), {}};
      AdjustmentInput input{.correspondences = correspondences,
                            .rig = dataset.rig,
                            .world_from_left = sides.starting,
                            .is_provisional = before == nullptr,
                            .apart = sides.apart,
                            .references = ReferencesOf(motions.steps)};
      if (before) {
        input.refined = before->refined;
        input.correction = before->rig_correction;
      }
      sides.adjustment = AdjustBundle(input, options);
      return sides;
    };
    Sides best = adjusted(
        RelaxPoses(StartingPoses(motions.steps, start), motions.steps, motions.loop_closures), {});
    const std::vector<int> weak = WeakLinks(motions.steps, best.adjustment);
    if (!weak.empty()) {
      const auto within = ClosuresWithin(weak, motions.loop_closures);
      Sides cut =
          adjusted(RelaxPoses(StartingPoses(motions.steps, {}), motions.steps, within), weak);
      // What else falls apart was tied across: the little that ties is then more than nothing.
      const bool falls_apart =
          GroupCount(cut.adjustment) > GroupCount(best.adjustment) + weak.size();
      if (!falls_apart) best = std::move(cut);
    }
    CarryGroupsAlong(best.starting, best.adjustment);
    // The odometry that carries them drifts; loop closures tie groups as well.
    CarryGroupsAlong(RelaxGroups(best.adjustment.world_from_left, best.adjustment.datum_frames,
                                 motions.steps, motions.loop_closures),
                     best.adjustment);
    const std::vector<int>& apart = best.apart;
    AdjustedPart part = LayInWorld(dataset, motions.steps, std::move(best.adjustment));
    const auto contradicted =
        TakeContradicted(part.adjustment.world_from_left, motions.steps, motions.loop_closures);
    part.loop_closures = std::move(motions.loop_closures);
    part.rests_on_mapping = !start.empty() && apart.empty();
    if (!apart.empty()) {
      part.remarks.push_back(fmt::format(
          "frames {}: the odometry knows the way there better than the few points that tie them to "
          "those before, and carries them",
          fmt::join(apart, ", ")));
      spdlog::warn("{}", part.remarks.back());
    }
    if (!contradicted.empty()) {
      part.remarks.push_back(DescribeContradicted(contradicted));
      spdlog::warn("{}", part.remarks.back());
    }
    return part;
  }

  // With the part's rig, near its poses: a step that was once lost was found by the matches since.
  // Which frames are keyframes stays as it was: they have been matched.
  Odometry StepsWith(const AdjustedPart& part) const {
    const auto expected = [&](int from, int to) {
      return std::optional(part.trajectory[to].world_from_left.Inverse() *
                           part.trajectory[from].world_from_left);
    };
    const StereoRig& rig = part.adjustment.rig;
    Odometry steps = TrackFrames(features.frame_count(), features.AsSource(), rig,
                                 bridging.odometry, MatchBy::kDescriptors, expected);
    steps = Bridged(dataset, rig, features, std::move(steps), bridging);
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i].keyframe = odometry[i].keyframe;
    return steps;
  }
};

AdjustedPart AdjustInTurn(const Adjuster& adjuster, const InTurn<StartingFrom>& ways) {
  const StartingFrom start = adjuster.Start(ways);
  AdjustedPart best = adjuster.From(start);
  if (start != ways.planned) {
    best.remarks.push_back(
        FailureReason(adjuster.of_mapping) +
        "; the adjustment started from the odometric poses instead of the mapped ones");
  }
  const Gates failed = adjuster.Judge(best);
  // With a corrected rig it has started from the odometry already.
  if (AllPassed(failed) || best.adjustment.IsRigCorrected() || ways.otherwise == start) {
    return best;
  }
  AdjustedPart other = adjuster.From(ways.otherwise);
  const bool is_better = AllPassed(adjuster.Judge(other));
  const std::string remark =
      fmt::format("{}; adjusting from the odometric poses {}", FailureReason(failed),
                  is_better ? "gave the result instead" : "did not mend it");
  spdlog::warn("{}", remark);
  AdjustedPart& kept = is_better ? other : best;
  kept.remarks.push_back(remark);
  return kept;
}

AdjustedPart MakeAdjusted(const StageContext&, const Dataset& dataset, const DatasetContent&,
                          const FeatureStore& features, const Odometry& odometry,
                          const Correspondences& matches, const KeyframeGraph& graph,
                          const AlignedKeyframes& aligned, const InTurn<StartingFrom>& ways,
                          const FeatureOptions& of_features, const CornerOptions& corners,
                          const MaskOptions& masks, const MatchingOptions& matching,
                          const AdjustmentOptions& options, const OdometryOptions& odometry_options,
                          const DeadReckoningOptions& rover, const FilterOptions& filter,
                          const MappingGateOptions& mapping_gates,
                          const AdjustmentGateOptions& gates) {
  const BridgingOptions bridging{of_features, corners, masks, odometry_options, rover, filter};
  const auto shape = ShapeOf(aligned.world_from_left.empty() ? nullptr : &aligned);
  return AdjustInTurn(
      {dataset, features, odometry, matches, PosesByFrame(aligned, graph, odometry.size()),
       JudgeMapping(shape, mapping_gates), matching, options, bridging, gates},
      ways);
}

void PublishRigOf(Publication& publication, const StageContext&, const AdjustedPart& part,
                  const Dataset& dataset, const DatasetContent& content, const FeatureStore&,
                  const Odometry&, const Correspondences&, const KeyframeGraph&,
                  const AlignedKeyframes&) {
  const Adjustment& adjustment = part.adjustment;
  PublishCalibration(dataset, content, adjustment, publication);
  if (adjustment.IsRigCorrected()) PublishRig(WithFilesOf(dataset, adjustment.rig), publication);
}

void PublishAdjusted(Publication& publication, const StageContext& context,
                     const AdjustedPart& part, const Dataset& dataset,
                     const DatasetContent& content, const FeatureStore& features,
                     const Odometry& odometry, const Correspondences& matches,
                     const KeyframeGraph& graph, const AlignedKeyframes& aligned) {
  PublishPosesAndPoints(part, dataset, publication);
  PublishRigOf(publication, context, part, dataset, content, features, odometry, matches, graph,
               aligned);
}

Report ReportAdjusted(const AdjustedPart& part, const Dataset& dataset, const DatasetContent&,
                      const FeatureStore&, const Odometry&, const Correspondences&,
                      const KeyframeGraph&, const AlignedKeyframes&) {
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
              "one pose per frame, the rig held and, where the images contradict it, corrected "
              "between rounds; points, sigmas, the trajectory",
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
