#include "workflows/stages/part_adjuster.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "adjustment/adjust.h"
#include "adjustment/carry_groups.h"
#include "adjustment/modelled_features.h"
#include "matching/loop_closures_by_rig.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "pose_graph/relax_poses.h"
#include "trajectory/starting_poses.h"
#include "trajectory/weak_links.h"
#include "workflows/stages/feature_sampler.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {
namespace {

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

// The sigma of the position that is known worst.
double WorstPosition_m(const Trajectory& trajectory) {
  double worst_m2 = 0.0;
  for (const TimedPose& pose : trajectory) {
    if (pose.IsMeasured()) worst_m2 = std::max(worst_m2, pose.position_covariance.trace());
  }
  return std::sqrt(worst_m2);
}

// A frame that is guessed instead of measured is no position known better.
bool IsKnownBetter(const Trajectory& trajectory, const Trajectory& other) {
  const auto measured = [](const Trajectory& poses) {
    return std::ranges::count_if(poses, &TimedPose::IsMeasured);
  };
  return measured(trajectory) >= measured(other) &&
         WorstPosition_m(trajectory) < WorstPosition_m(other);
}

}  // namespace

AdjustedPart PartAdjuster::From(const Poses& mapped) const {
  const Motions motions{input_.odometry, input_.matches.loop_closures};
  AdjustedPart part = From(mapped, input_.matches, motions, nullptr);
  if (part.adjustment.IsRigCorrected()) part = WithItsRig(std::move(part));
  if (IsBesideModel(part.adjustment)) return WithStepsAsModelled(std::move(part));
  return part;
}

// With the rig that `part` has found to be the right one. Matches had to agree with the other:
// where that moves a pixel by more than their noise only some did, and those that by chance
// agree.
AdjustedPart PartAdjuster::WithItsRig(AdjustedPart part) const {
  // They are found anew; those of a long traverse need not lie beside the second adjustment.
  part.adjustment.points = std::vector<AdjustedPoint>();
  const bool matches_anew = part.adjustment.correction_px > options_.matching.keypoint_noise_px;
  const StereoRig& rig = part.adjustment.rig;
  Odometry steps = StepsWith(part, input_.features.AsSource());
  std::optional<Correspondences> anew;
  if (matches_anew) {
    anew = MatchFrames(steps, input_.features.AsSource(), rig, options_.matching,
                       SamplerOf(input_.dataset, rig, input_.features.rig_fixed(),
                                 options_.bridging.features, options_.bridging.masks));
  }
  auto loop_closures =
      anew ? anew->loop_closures : LoopClosuresByRig(input_.matches, rig, options_.matching);
  AdjustedPart measured_anew = From({}, anew ? *anew : input_.matches,
                                    {std::move(steps), std::move(loop_closures)}, &part.adjustment);
  measured_anew.remarks.push_back(fmt::format(
      "the images contradict the calibration: the rig was corrected (rig_refined.yaml), {} anew "
      "with it",
      matches_anew ? "odometry and matching done" : "the odometry done"));
  return measured_anew;
}

AdjustedPart PartAdjuster::From(const Poses& mapped, const Correspondences& correspondences,
                                Motions motions, const Adjustment* before) const {
  const auto adjusted = [&](Poses starting, std::vector<int> apart) {
    Sides sides{std::move(starting), std::move(apart), {}};
    AdjustmentInput from{.correspondences = correspondences,
                         .rig = input_.dataset.rig,
                         .world_from_left = sides.starting,
                         .is_provisional = before == nullptr,
                         .apart = sides.apart,
                         .references = ReferencesOf(motions.steps)};
    if (before) {
      from.refined = before->refined;
      from.correction = before->rig_correction;
    }
    sides.adjustment = AdjustBundle(from, options_.adjustment);
    return sides;
  };
  const auto laid = [&](Sides sides) {
    CarryGroupsAlong(sides.starting, sides.adjustment);
    // The odometry that carries them drifts; loop closures tie groups as well.
    CarryGroupsAlong(RelaxGroups(sides.adjustment.world_from_left, sides.adjustment.datum_frames,
                                 motions.steps, motions.loop_closures),
                     sides.adjustment);
    return LayInWorld(input_.dataset, motions.steps, std::move(sides.adjustment));
  };
  Sides tied = adjusted(
      RelaxPoses(StartingPoses(motions.steps, mapped), motions.steps, motions.loop_closures), {});
  std::vector<int> apart = WeakLinks(motions.steps, tied.adjustment);
  AdjustedPart part = laid(std::move(tied));
  if (!apart.empty()) {
    const auto within = ClosuresWithin(apart, motions.loop_closures);
    AdjustedPart cut =
        laid(adjusted(RelaxPoses(StartingPoses(motions.steps, {}), motions.steps, within), apart));
    // What was tied across the cuts falls apart as well: the little that ties may be more than
    // none.
    if (IsKnownBetter(cut.trajectory, part.trajectory)) {
      part = std::move(cut);
    } else {
      apart.clear();
    }
  }
  const auto contradicted =
      TakeContradicted(part.adjustment.world_from_left, motions.steps, motions.loop_closures);
  part.loop_closures = std::move(motions.loop_closures);
  part.rests_on_mapping = !mapped.empty() && apart.empty();
  if (!apart.empty()) {
    part.remarks.push_back(fmt::format(
        "frames {}: the odometry knows the way there better than the few points that tie them to "
        "those before, and carries them",
        fmt::join(apart, ", ")));
  }
  if (!contradicted.empty()) part.remarks.push_back(DescribeContradicted(contradicted));
  return part;
}

// Frames that only the odometry knows are off by what it lacks, and nothing else could be compared
// with the adjusted ones.
AdjustedPart PartAdjuster::WithStepsAsModelled(AdjustedPart part) const {
  const Odometry steps = StepsWith(part, AsModelled(input_.features.AsSource(), part.adjustment));
  // What is known of a motion is not known of one against another reference.
  for (std::size_t i = 0; i < part.adjustment.link_covariances.size(); ++i) {
    if (steps[i].reference == part.odometry[i].reference) continue;
    part.adjustment.link_covariances[i].reset();
  }
  AdjustedPart laid = LayInWorld(input_.dataset, steps, std::move(part.adjustment));
  laid.loop_closures = std::move(part.loop_closures);
  laid.rests_on_mapping = part.rests_on_mapping;
  laid.remarks = std::move(part.remarks);
  return laid;
}

// With the part's rig, near its poses: a step that was once lost was found by the matches since.
// Which frames are keyframes stays as it was: they have been matched.
Odometry PartAdjuster::StepsWith(const AdjustedPart& part, const FeatureSource& features) const {
  const auto expected = [&](int from, int to) {
    return std::optional(part.trajectory[to].world_from_left.Inverse() *
                         part.trajectory[from].world_from_left);
  };
  const StereoRig& rig = part.adjustment.rig;
  Odometry steps = TrackFrames(input_.features.frame_count(), features, rig,
                               options_.bridging.odometry, MatchBy::kDescriptors, expected);
  steps = Bridged(input_.dataset, rig, input_.features, std::move(steps), options_.bridging);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].keyframe = input_.odometry[i].keyframe;
  return steps;
}

}  // namespace rigmap
