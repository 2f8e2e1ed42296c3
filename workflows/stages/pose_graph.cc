#include "workflows/stages/pose_graph.h"

#include <map>

#include "export/g2o.h"
#include "pipeline/code_identity.h"
#include "pose_graph/part_graph.h"
#include "trajectory/adjusted_steps.h"

namespace rigmap {
namespace {

Report Describe(const PartGraph& part) {
  std::map<std::string_view, int> counts;
  Report kinds = Report::array(), stamps = Report::array();
  for (const PoseEdge& edge : part.graph.edges) {
    ++counts[Name(edge.kind)];
    kinds.push_back(Name(edge.kind));
  }
  for (const PoseNode& node : part.graph.nodes) stamps.push_back(node.stamp_ns);
  Report edges = Report::object();
  for (const auto& [kind, count] : counts) edges[std::string(kind)] = count;
  return {{"frame", "world"},
          {"vertices", "world_from_left: tx ty tz qx qy qz qw, metres; id: index into stamps_ns"},
          {"edges", "a_from_b: tx ty tz qx qy qz qw"},
          {"information",
           "upper triangle, row by row, of tx ty tz qx qy qz: the motion from the measured to the "
           "actual b, along b's measured axes, with the quaternion's vector part; of steps between "
           "adjusted poses as the adjustment knows them, noise and calibration together"},
          {"edge_counts", std::move(edges)},
          {"stamps_ns", std::move(stamps)},
          {"edge_kinds", std::move(kinds)}};
}

PoseGraphText MakePoseGraph(const StageContext&, const AdjustedPart& part) {
  std::vector<std::optional<Rigid3>> poses;
  for (const auto& pose : part.adjustment.world_from_left) {
    poses.push_back(pose ? std::optional(part.world_from_gauge * *pose) : std::nullopt);
  }
  const PartGraph graph = BuildPartGraph(poses, part.odometry, part.loop_closures,
                                         AdjustedSteps(part.odometry, part.adjustment));
  return {WriteG2o(graph.graph), Describe(graph).dump(1) + "\n"};
}

void PublishPoseGraph(Publication& publication, const StageContext&, const PoseGraphText& text,
                      const AdjustedPart&) {
  publication.File("posegraph.g2o", [&](std::ostream& stream) { stream << text.g2o; });
  publication.File("posegraph.json", [&](std::ostream& stream) { stream << text.json; });
}

}  // namespace

PoseGraphStage PartPoseGraph() {
  return {.name = "pose_graph",
          .about = "adjusted poses with the steps and loop closures between them, for g2o",
          .code = CodeHere(),
          .make = MakePoseGraph,
          .publishes = {"posegraph.g2o", "posegraph.json"},
          .publish = PublishPoseGraph};
}

}  // namespace rigmap
