#include "export/g2o.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <sstream>

namespace rigmap {
namespace {

// As a reader does that knows g2o's definitions and nothing of ours.
struct Read {
  std::vector<Eigen::Isometry3d> vertices;
  int a = -1, b = -1;
  Eigen::Isometry3d measured = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information;

  explicit Read(const std::string& text) {
    std::istringstream stream(text);
    std::string tag;
    const auto pose = [&] {
      double x, y, z, qx, qy, qz, qw;
      stream >> x >> y >> z >> qx >> qy >> qz >> qw;
      Eigen::Isometry3d result(Eigen::Quaterniond(qw, qx, qy, qz));
      result.translation() << x, y, z;
      return result;
    };
    while (stream >> tag) {
      if (tag == "VERTEX_SE3:QUAT") {
        int id;
        stream >> id;
        EXPECT_EQ(id, static_cast<int>(vertices.size()));
        vertices.push_back(pose());
      } else {
        EXPECT_EQ(tag, "EDGE_SE3:QUAT");
        stream >> a >> b;
        measured = pose();
        for (int i = 0; i < 6; ++i) {
          for (int j = i; j < 6; ++j) {
            stream >> information(i, j);
            information(j, i) = information(i, j);
          }
        }
      }
    }
  }

  double Chi2() const {
    const Eigen::Isometry3d off = measured.inverse() * (vertices[a].inverse() * vertices[b]);
    Eigen::Matrix<double, 6, 1> error;
    error << off.translation(), Eigen::Quaterniond(off.linear()).vec();
    return error.dot(information * error);
  }
};

PoseGraph Graph(const Rigid3& off) {
  const Rigid3 world_from_a{ExpRotation({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  const Rigid3 b_from_a{ExpRotation({0.3, -0.2, 0.1}), {0.5, 0.1, -0.2}};
  PoseGraph graph;
  graph.nodes.push_back({.stamp_ns = 1, .world_from_left = world_from_a});
  graph.nodes.push_back(
      {.stamp_ns = 2, .world_from_left = world_from_a * (off * b_from_a).Inverse()});
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 0.01, 0.04, 0.09, 1e-4, 4e-4, 9e-4;
  graph.edges.push_back({0, 1, b_from_a, SqrtInformation(covariance)});
  return graph;
}

TEST(G2o, AnotherReaderFindsPosesAndMotion) {
  const Read read(WriteG2o(Graph(Rigid3())));
  ASSERT_EQ(read.vertices.size(), 2U);
  EXPECT_NEAR(read.vertices[0].translation().y(), 2.0, 1e-9);
  EXPECT_NEAR(read.Chi2(), 0.0, 1e-9);
}

TEST(G2o, AnErrorWeighsAsMuchThereAsHere) {
  // One sigma along x, two about z.
  const Rigid3 off{ExpRotation({0.0, 0.0, 0.06}), {0.1, 0.0, 0.0}};
  EXPECT_NEAR(Read(WriteG2o(Graph(off))).Chi2(), 5.0, 0.1);
}

}  // namespace
}  // namespace rigmap
