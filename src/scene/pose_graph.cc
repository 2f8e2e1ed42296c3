#include "scene/pose_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

namespace rigmap {

Matrix6d SqrtInformation(const Matrix6d& covariance) {
  const Matrix6d root = covariance.llt().matrixL();
  return root.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
}

std::vector<int> FirstOfGroups(const PoseGraph& graph) {
  std::vector<int> first(graph.nodes.size());
  std::iota(first.begin(), first.end(), 0);
  for (bool joined = true; joined;) {
    joined = false;
    for (const PoseEdge& edge : graph.edges) {
      const int least = std::min(first[edge.a], first[edge.b]);
      joined = joined || first[edge.a] != least || first[edge.b] != least;
      first[edge.a] = first[edge.b] = least;
    }
  }
  return first;
}

}  // namespace rigmap
