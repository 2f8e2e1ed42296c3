#include "pose_graph/internal/optimise_pose_graph.h"

#include <gmock/gmock.h>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using testing::ElementsAre;

constexpr double kSigma_m = 0.01, kSigma_rad = 0.004;

Matrix6d Diagonal(double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

PoseEdge Measured(const std::vector<Rigid3>& truth, int a, int b, PoseEdgeKind kind) {
  return {a, b, truth[b].Inverse() * truth[a], SqrtInformation(Diagonal(kSigma_m, kSigma_rad)),
          kind};
}

double Distance_m(const PoseNode& node, const Rigid3& pose) {
  return (node.world_from_left.translation - pose.translation).norm();
}
double Angle_rad(const PoseNode& node, const Rigid3& pose) {
  return AngleOf(node.world_from_left.rotation.conjugate() * pose.rotation);
}

// Poses at random, a chain of true steps and a true closure of its ends, begun off the truth.
class PoseGraphTest : public testing::Test {
 protected:
  PoseGraphTest() {
    for (int i = 0; i < kNodes; ++i) truth_.push_back(random_.Motion(2.0));
    for (int i = 0; i < kNodes; ++i) {
      const Rigid3 off{ExpRotation(random_.Noise(0.05)), random_.Noise(0.1)};
      graph_.nodes.push_back({i, i == 0 ? truth_[i] : truth_[i] * off, {}});
      if (i > 0) graph_.edges.push_back(Measured(truth_, i - 1, i, PoseEdgeKind::kOdometry));
    }
    graph_.edges.push_back(Measured(truth_, 0, kNodes - 1, PoseEdgeKind::kLoopClosure));
  }

  static constexpr int kNodes = 12;
  SeededRandom random_;
  std::vector<Rigid3> truth_;
  PoseGraph graph_;
};

TEST_F(PoseGraphTest, AConsistentGraphIsRecoveredExactly) {
  const PoseGraph solved = OptimisePoseGraph(graph_);
  for (int i = 0; i < kNodes; ++i) {
    EXPECT_LT(Distance_m(solved.nodes[i], truth_[i]), 1e-6);
    EXPECT_LT(Angle_rad(solved.nodes[i], truth_[i]), 1e-6);
  }
  for (const PoseEdge& edge : solved.edges) EXPECT_LT(ErrorSigmas(edge, solved), 1e-3);
}

TEST_F(PoseGraphTest, TheFirstNodeIsHeldAndEqualInputGivesEqualOutput) {
  const PoseGraph once = OptimisePoseGraph(graph_), again = OptimisePoseGraph(graph_);
  EXPECT_EQ(once.nodes[0].world_from_left.translation, truth_[0].translation);
  EXPECT_EQ(once.nodes[0].world_from_left.rotation.coeffs(), truth_[0].rotation.coeffs());
  for (int i = 0; i < kNodes; ++i) {
    EXPECT_EQ(once.nodes[i].world_from_left.translation,
              again.nodes[i].world_from_left.translation);
  }
}

TEST_F(PoseGraphTest, MovesWithItsGauge) {
  graph_.edges.back().b_from_a.translation += random_.Noise(0.02);
  const Rigid3 elsewhere = random_.Motion(10.0);
  PoseGraph moved = graph_;
  for (PoseNode& node : moved.nodes) node.world_from_left = elsewhere * node.world_from_left;
  EXPECT_NEAR(ErrorSigmas(moved.edges.back(), moved), ErrorSigmas(graph_.edges.back(), graph_),
              1e-6);
  const PoseGraph here = OptimisePoseGraph(graph_), there = OptimisePoseGraph(moved);
  for (int i = 0; i < kNodes; ++i) {
    const Rigid3 expected = elsewhere * here.nodes[i].world_from_left;
    EXPECT_LT(Distance_m(there.nodes[i], expected), 1e-4);
    EXPECT_LT(Angle_rad(there.nodes[i], expected), 1e-4);
  }
}

TEST_F(PoseGraphTest, AWrongClosurePullsLittleAndAWrongStepMuch) {
  for (const PoseEdgeKind kind : {PoseEdgeKind::kLoopClosure, PoseEdgeKind::kWheels}) {
    PoseGraph graph = graph_;
    for (int i = 0; i < kNodes; ++i) graph.nodes[i].world_from_left = truth_[i];
    PoseEdge wrong = Measured(truth_, 3, 9, kind);
    wrong.b_from_a.translation += Eigen::Vector3d(1.0, -2.0, 0.5);
    graph.edges.push_back(wrong);
    const PoseGraph solved = OptimisePoseGraph(graph);
    double worst_m = 0.0;
    for (int i = 0; i < kNodes; ++i) {
      worst_m = std::max(worst_m, Distance_m(solved.nodes[i], truth_[i]));
    }
    if (kind == PoseEdgeKind::kLoopClosure) {
      EXPECT_LT(worst_m, 0.02);
      EXPECT_GT(ErrorSigmas(wrong, solved), 50.0);
    } else {
      EXPECT_GT(worst_m, 0.2);
    }
  }
}

TEST_F(PoseGraphTest, GroupsKeepTheirOwnGauge) {
  PoseGraph two = graph_;
  std::erase_if(two.edges, [](const PoseEdge& e) { return e.b == 5 || e.a == 0; });
  // What is left: node 0 alone, 1 to 4, 5 to 11.
  EXPECT_THAT(FirstOfGroups(two), ElementsAre(0, 1, 1, 1, 1, 5, 5, 5, 5, 5, 5, 5));
  const PoseGraph solved = OptimisePoseGraph(two);
  for (const int held : {0, 1, 5}) {
    EXPECT_EQ(solved.nodes[held].world_from_left.translation,
              two.nodes[held].world_from_left.translation);
  }
  for (const PoseEdge& edge : solved.edges) EXPECT_LT(ErrorSigmas(edge, solved), 1e-3);
}

TEST_F(PoseGraphTest, AFixWithoutRotationLeavesItAlone) {
  PoseEdge fix{0, 1, Rigid3{truth_[4].rotation, {1.0, 2.0, 3.0}}, Matrix6d::Zero(),
               PoseEdgeKind::kFix};
  fix.sqrt_information.topLeftCorner<3, 3>() = 100.0 * Eigen::Matrix3d::Identity();
  PoseGraph graph{.nodes = {graph_.nodes[0], graph_.nodes[1]}, .edges = {fix}};
  const PoseGraph once = OptimisePoseGraph(graph);
  EXPECT_LT(ErrorSigmas(fix, once), 1e-3);
  EXPECT_TRUE((fix.Information().bottomRightCorner<3, 3>().isZero()));
}

TEST_F(PoseGraphTest, CovariancesOfAnotherSolutionAreDropped) {
  for (PoseNode& node : graph_.nodes) node.covariance = Matrix6d::Identity();
  for (const PoseNode& node : OptimisePoseGraph(graph_).nodes) EXPECT_FALSE(node.covariance);
}

TEST(PoseEdge, InformationIsTheInverseOfTheCovariance) {
  SeededRandom random;
  Matrix6d root = Matrix6d::Identity();
  for (int i = 0; i < 6; ++i) root.block<3, 1>(i / 2, i) += random.Vector(0.5);
  const Matrix6d covariance = root * root.transpose() + 0.1 * Matrix6d::Identity();
  PoseEdge edge;
  edge.sqrt_information = SqrtInformation(covariance);
  EXPECT_TRUE((edge.Information() * covariance).isIdentity(1e-9));
}

TEST(PoseEdge, ErrorsAreCountedInSigmasOfTheLeftPerturbation) {
  PoseGraph graph{.nodes = {{}, {}}, .edges = {{}}};
  PoseEdge& edge = graph.edges[0];
  edge.b = 1;
  edge.sqrt_information = SqrtInformation(Diagonal(kSigma_m, kSigma_rad));
  graph.nodes[0].world_from_left.translation.x() = 3.0 * kSigma_m;
  EXPECT_NEAR(ErrorSigmas(edge, graph), 3.0, 1e-9);
  graph.nodes[0].world_from_left = {ExpRotation({0.0, 2.0 * kSigma_rad, 0.0}),
                                    Eigen::Vector3d::Zero()};
  EXPECT_NEAR(ErrorSigmas(edge, graph), 2.0, 1e-4);
}

}  // namespace
}  // namespace rigmap
