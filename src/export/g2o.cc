#include "export/g2o.h"

#include <fmt/format.h>

#include <iterator>

namespace rigmap {
namespace {

std::string PoseText(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return fmt::format("{:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f} {:.12f}", t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
}

// Of an error whose rotation is counted by half.
Matrix6d InformationOfG2o(const PoseEdge& edge) {
  Vector6d ours_from_g2o = Vector6d::Ones();
  ours_from_g2o.tail<3>().setConstant(2.0);
  return ours_from_g2o.asDiagonal() * edge.Information() * ours_from_g2o.asDiagonal();
}

}  // namespace

std::string WriteG2o(const PoseGraph& graph) {
  std::string text;
  const auto to = std::back_inserter(text);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    fmt::format_to(to, "VERTEX_SE3:QUAT {} {}\n", i, PoseText(graph.nodes[i].world_from_left));
  }
  for (const PoseEdge& edge : graph.edges) {
    fmt::format_to(to, "EDGE_SE3:QUAT {} {} {}", edge.a, edge.b, PoseText(edge.b_from_a.Inverse()));
    const Matrix6d information = InformationOfG2o(edge);
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        fmt::format_to(to, " {:.9g}", information(row, column));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace rigmap
