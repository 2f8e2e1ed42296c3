#include "pose_graph/relax_poses.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "geometry/adjoint.h"
#include "pose_graph/internal/optimise_pose_graph.h"
#include "pose_graph/part_graph.h"

namespace rigmap {
namespace {

constexpr double kMaxSigmas = 5.0;
// All loop closures nearer than this (six pixels): bundle adjustment needs no help.
constexpr double kAgreeingSigmas = 4.0;

bool IsClosure(const PoseEdge& edge) { return edge.kind == PoseEdgeKind::kLoopClosure; }

std::vector<std::optional<Rigid3>> PosesOf(const PoseGraph& graph, const std::vector<int>& frames,
                                           std::size_t count) {
  std::vector<std::optional<Rigid3>> poses(count);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    poses[frames[i]] = graph.nodes[i].world_from_left;
  }
  return poses;
}

// A node for each group, its first frame, and the edges between frames of different groups.
struct GroupGraph {
  PoseGraph graph;
  std::vector<int> node_of;  // per node of the frames' graph
};

GroupGraph GroupsOf(const PartGraph& part, const std::vector<int>& group) {
  GroupGraph groups;
  std::map<int, int> known;
  for (std::size_t i = 0; i < part.frames.size(); ++i) {
    const int next = static_cast<int>(groups.graph.nodes.size());
    const auto [node, is_new] = known.try_emplace(group[part.frames[i]], next);
    if (is_new) groups.graph.nodes.push_back(part.graph.nodes[i]);
    groups.node_of.push_back(node->second);
  }
  const auto in_group = [&](int i) {
    const Rigid3& first = groups.graph.nodes[groups.node_of[i]].world_from_left;
    return first.Inverse() * part.graph.nodes[i].world_from_left;
  };
  for (const PoseEdge& edge : part.graph.edges) {
    const int a = groups.node_of[edge.a], b = groups.node_of[edge.b];
    if (a == b) continue;
    const Rigid3 to_b = in_group(edge.b);
    groups.graph.edges.push_back({a, b, to_b * edge.b_from_a * in_group(edge.a).Inverse(),
                                  edge.sqrt_information * Adjoint(to_b.Inverse()), edge.kind});
  }
  return groups;
}

// Nothing where all loop closures agree already or none is believed.
std::optional<PoseGraph> Relaxed(PoseGraph graph) {
  const auto is_off = [](const PoseEdge& edge, const PoseGraph& at, double sigmas) {
    return IsClosure(edge) && !(ErrorSigmas(edge, at) <= sigmas);
  };
  if (std::ranges::none_of(graph.edges,
                           [&](const auto& e) { return is_off(e, graph, kAgreeingSigmas); })) {
    return std::nullopt;
  }
  PoseGraph relaxed = OptimisePoseGraph(graph);
  const auto disbelieved =
      std::erase_if(graph.edges, [&](const auto& e) { return is_off(e, relaxed, kMaxSigmas); });
  const auto believed = std::ranges::count_if(graph.edges, IsClosure);
  spdlog::info("{} loop closures, {} of them not believed",
               static_cast<std::size_t>(believed) + disbelieved, disbelieved);
  if (disbelieved == 0) return relaxed;
  return believed == 0 ? std::nullopt : std::optional(OptimisePoseGraph(graph));
}

}  // namespace

std::vector<std::optional<Rigid3>> RelaxPoses(
    const std::vector<std::optional<Rigid3>>& world_from_left, const Odometry& odometry,
    const std::vector<LoopClosure>& loop_closures) {
  const PartGraph part = BuildPartGraph(world_from_left, odometry, loop_closures);
  const auto relaxed = Relaxed(part.graph);
  return relaxed ? PosesOf(*relaxed, part.frames, world_from_left.size()) : world_from_left;
}

std::vector<std::optional<Rigid3>> RelaxGroups(
    const std::vector<std::optional<Rigid3>>& world_from_left, const std::vector<int>& group,
    const Odometry& odometry, const std::vector<LoopClosure>& loop_closures) {
  const PartGraph part = BuildPartGraph(world_from_left, odometry, loop_closures);
  const GroupGraph groups = GroupsOf(part, group);
  const auto relaxed = Relaxed(groups.graph);
  if (!relaxed) return world_from_left;
  std::vector<std::optional<Rigid3>> poses = world_from_left;
  for (std::size_t i = 0; i < part.frames.size(); ++i) {
    const int node = groups.node_of[i];
    const Rigid3 move =
        relaxed->nodes[node].world_from_left * groups.graph.nodes[node].world_from_left.Inverse();
    poses[part.frames[i]] = move * part.graph.nodes[i].world_from_left;
  }
  return poses;
}

std::vector<LoopClosure> TakeContradicted(const std::vector<std::optional<Rigid3>>& world_from_left,
                                          const Odometry& odometry,
                                          std::vector<LoopClosure>& loop_closures) {
  const PartGraph part = BuildPartGraph(world_from_left, odometry, loop_closures);
  std::vector<LoopClosure> contradicted, believed;
  auto edge =
      std::ranges::find_if(part.graph.edges, IsClosure);  // one for each that has both poses
  for (LoopClosure& loop_closure : loop_closures) {
    const bool has_edge = world_from_left[loop_closure.a] && world_from_left[loop_closure.b];
    const bool is_off = has_edge && !(ErrorSigmas(*edge++, part.graph) <= kMaxSigmas);
    (is_off ? contradicted : believed).push_back(std::move(loop_closure));
  }
  loop_closures = std::move(believed);
  return contradicted;
}

}  // namespace rigmap
