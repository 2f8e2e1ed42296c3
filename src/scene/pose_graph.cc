#include "scene/pose_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/disjoint_sets.h"

namespace rigmap {

Matrix6d SqrtInformation(const Matrix6d& covariance) {
  const Matrix6d root = covariance.llt().matrixL();
  return root.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
}

std::vector<int> FirstOfGroups(const PoseGraph& graph) {
  DisjointSets groups(graph.nodes.size());
  for (const PoseEdge& edge : graph.edges) {
    const auto [first, other] = std::minmax({groups.Root(edge.a), groups.Root(edge.b)});
    groups.Unite(first, other);
  }
  std::vector<int> first(graph.nodes.size());
  for (std::size_t node = 0; node < first.size(); ++node) {
    first[node] = groups.Root(static_cast<int>(node));
  }
  return first;
}

}  // namespace rigmap
