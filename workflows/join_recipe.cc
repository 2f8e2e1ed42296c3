#include "workflows/join_recipe.h"

#include <fmt/format.h>

#include "workflows/stages/adjustment.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/matching.h"
#include "workflows/stages/odometric_adjustment.h"
#include "workflows/stages/pose_graph.h"
#include "workflows/stages/sensor_gates.h"
#include "workflows/surface_recipe.h"

namespace rigmap {
namespace {

// COLMAP maps parts; the whole is adjusted from the odometry, which every part's mapping agrees
// with.
KeyframeGraph NoGraph(const StageContext&, const Odometry&) { return {}; }
AlignedKeyframes NoMapping(const StageContext&, const Odometry&) { return {}; }

std::string KeyOf(const JoinedParts& parts) {
  std::string text(parts.keyframes.begin(), parts.keyframes.end());
  for (const auto& part : parts.parts) {
    text += part.name + part.status;
    for (const auto& [frame, pose] : part.world_from_left) {
      const Eigen::Vector3d& t = pose.translation;
      const Eigen::Quaterniond& q = pose.rotation;
      text += fmt::format(" {} {} {} {} {} {} {} {}", frame, t.x(), t.y(), t.z(), q.x(), q.y(),
                          q.z(), q.w());
    }
  }
  for (const std::string& sentence : parts.missing) text += sentence;
  for (const int part : parts.first_part) text += std::to_string(part);
  for (const FrameFile& file : parts.features) text += file.name + file.key;
  return HashText(text);
}

std::string KeyOf(const KnownDepths& depths) {
  std::string text;
  for (const auto& known : depths.of_frames) {
    text += known ? known->file.name + known->file.key + known->how : "-";
  }
  return HashText(text);
}

std::string KeyOf(const SplitFixes& fixes) {
  return HashText(DescribeTruth({"", fixes.tying, {}}) + "judged by" +
                  DescribeTruth({"", fixes.judging, {}}));
}

}  // namespace

StageGraph JoinRecipe(const Dataset& data, const DatasetContent& data_content,
                      const JoinedParts& joined_parts, const KnownDepths& part_depths,
                      const std::optional<SplitFixes>& tie_to, const PartOptions& o) {
  StageGraph g;
  const auto judges = tie_to ? std::optional(tie_to->judging) : std::nullopt;
  const auto [dataset, content, truth, fixes, colmap] =
      AddPartInputs(g, data, data_content, o.colmap, judges);
  const auto open_parts = [joined_parts] { return std::pair(KeyOf(joined_parts), joined_parts); };
  const auto open_depths = [part_depths] { return std::pair(KeyOf(part_depths), part_depths); };
  const auto parts = g.AddSource<JoinedParts>("parts", open_parts, ReportParts);
  const auto known_depths = g.AddSource<KnownDepths>("part_depths", open_depths);

  const auto found = g.AddStage(JoinedFeatures(), Reading(), dataset, parts);
  const auto features = g.AddView(OpenFeatures, found);
  const auto odometry =
      g.AddStage(JoinedOdometry(),
                 Reading(o.features, o.corners, o.masks, o.odometry, o.dead_reckoning, o.filter),
                 dataset, features, parts);
  const auto matches =
      g.AddStage(Matching(), Reading(o.matching, o.features, o.masks), dataset, features, odometry);
  const auto graph = g.AddView(NoGraph, odometry);
  const auto aligned = g.AddView(NoMapping, odometry);
  const auto from_odometry =
      g.AddStage(OdometricAdjustment(),
                 Reading(o.features, o.corners, o.masks, o.matching, o.adjustment, o.odometry,
                         o.dead_reckoning, o.filter),
                 dataset, features, odometry, matches);
  AdjustmentStage adjustment = RigAdjustment();
  if (tie_to) PublishCalibrationOnly(adjustment);
  const auto adjusted = g.AddStage(
      adjustment,
      Reading(StartingFrom::kOdometry, o.features, o.corners, o.masks, o.matching, o.adjustment,
              o.odometry, o.dead_reckoning, o.filter, o.gates.mapping, o.gates.adjustment),
      dataset, content, features, odometry, matches, graph, aligned, from_odometry);
  const auto own_gates =
      g.AddCheck(AdjustedGates(),
                 Reading(o.gates.mapping, o.gates.poses, o.gates.adjustment, o.gates.calibration),
                 dataset, found, aligned, adjusted);
  const auto sensor_gates =
      g.AddCheck(SensorGates(), Reading(o.dead_reckoning, o.filter), dataset, adjusted);
  const auto gates = g.AddView(WithMoreGates, g.AddView(WithMoreGates, own_gates, sensor_gates),
                               g.AddCheck(JoinGates(), Reading(), parts, adjusted));
  auto final_part = adjusted;
  if (tie_to) {
    const auto open_fixes = [all = *tie_to] { return std::pair(KeyOf(all), all); };
    const auto split = g.AddSource<SplitFixes>("split_fixes", open_fixes);
    final_part = g.AddView(
        PartOf, g.AddStage(TieToFixes(), Reading(o.georeference), dataset, adjusted, parts, split));
  }
  g.AddStage(PartPoseGraph(), Reading(), final_part);
  const auto posed = g.AddView(PosedByAdjustment, dataset, final_part);
  const auto steps = g.AddStage(JoinedSteps(), Reading(), odometry, adjusted, parts);

  const SurfaceInputs in{dataset, content, truth, fixes, found, posed, gates, steps};
  const auto depths = g.AddStage(JoinedDepths(), Reading(o.dense, o.masks, o.voxel), dataset,
                                 content, found, posed, known_depths);
  const auto depth_gates = AddDepthProducts(g, o, in, depths);
  const auto map = g.AddStage(Fusion(), Reading(o.fusion), dataset, posed, depths);
  AddMapProducts(g, o, in, depth_gates, map);
  return g;
}

std::vector<std::string> JoinStageNames() {
  return JoinRecipe({}, {}, {}, {}, SplitFixes(), {}).StageNames();
}

}  // namespace rigmap
