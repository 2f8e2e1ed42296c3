#include "scene/pose_graph.h"

#include <gmock/gmock.h>

#include <set>

namespace rigmap {
namespace {

using testing::ElementsAre;

PoseEdge Between(int a, int b) { return {.a = a, .b = b, .b_from_a = {}}; }

TEST(PoseGraph, FirstOfGroupsFollowsEdgesInAnyOrderAndDirection) {
  PoseGraph graph;
  graph.nodes.resize(8);
  // 6-4-1 in two edges of which the later one joins; 7-2 apart from them; 0, 3 and 5 alone.
  graph.edges = {Between(6, 4), Between(7, 2), Between(1, 6), Between(4, 1)};
  EXPECT_THAT(FirstOfGroups(graph), ElementsAre(0, 1, 2, 3, 1, 5, 1, 2));
}

TEST(PoseGraph, RootOfTheInformationIsThatOfTheInverseCovariance) {
  Matrix6d mixing = Matrix6d::Identity();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) mixing(i, j) = 0.3 * (i + 1) - 0.2 * j;
  }
  const Matrix6d covariance = 1e-4 * mixing * mixing.transpose();
  PoseEdge edge = Between(0, 1);
  edge.sqrt_information = SqrtInformation(covariance);
  EXPECT_TRUE((edge.Information() * covariance).isApprox(Matrix6d::Identity(), 1e-9));
}

TEST(PoseGraph, EveryKindOfEdgeHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const auto kind : {PoseEdgeKind::kOdometry, PoseEdgeKind::kLoopClosure, PoseEdgeKind::kSeam,
                          PoseEdgeKind::kWheels, PoseEdgeKind::kFix}) {
    EXPECT_FALSE(Name(kind).empty());
    names.insert(Name(kind));
  }
  EXPECT_EQ(names.size(), 5U);
}

}  // namespace
}  // namespace rigmap
