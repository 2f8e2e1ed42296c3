#include "pose_graph/relax_poses.h"

#include <spdlog/spdlog.h>

#include <algorithm>

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

}  // namespace

std::vector<std::optional<Rigid3>> RelaxPoses(
    const std::vector<std::optional<Rigid3>>& world_from_left, const Odometry& odometry,
    const std::vector<LoopClosure>& loop_closures) {
  PartGraph part = BuildPartGraph(world_from_left, odometry, loop_closures);
  PoseGraph& graph = part.graph;
  const auto is_off = [](const PoseEdge& edge, const PoseGraph& at, double sigmas) {
    return IsClosure(edge) && !(ErrorSigmas(edge, at) <= sigmas);
  };
  if (std::ranges::none_of(graph.edges,
                           [&](const auto& e) { return is_off(e, graph, kAgreeingSigmas); })) {
    return world_from_left;
  }
  const PoseGraph relaxed = OptimisePoseGraph(graph);
  const auto disbelieved =
      std::erase_if(graph.edges, [&](const auto& e) { return is_off(e, relaxed, kMaxSigmas); });
  const auto believed = std::ranges::count_if(graph.edges, IsClosure);
  spdlog::info("{} loop closures, {} of them not believed",
               static_cast<std::size_t>(believed) + disbelieved, disbelieved);
  const std::size_t count = world_from_left.size();
  if (disbelieved == 0) return PosesOf(relaxed, part.frames, count);
  return believed == 0 ? world_from_left : PosesOf(OptimisePoseGraph(graph), part.frames, count);
}

std::vector<LoopClosure> TakeContradicted(const std::vector<std::optional<Rigid3>>& world_from_left,
                                          const Odometry& odometry,
                                          std::vector<LoopClosure>& loop_closures) {
  std::vector<LoopClosure> contradicted;
  std::erase_if(loop_closures, [&](const LoopClosure& loop_closure) {
    const PoseGraph graph = BuildPartGraph(world_from_left, odometry, {loop_closure}).graph;
    const bool is_off = std::ranges::any_of(graph.edges, [&](const PoseEdge& edge) {
      return IsClosure(edge) && !(ErrorSigmas(edge, graph) <= kMaxSigmas);
    });
    if (is_off) contradicted.push_back(loop_closure);
    return is_off;
  });
  return contradicted;
}

}  // namespace rigmap
