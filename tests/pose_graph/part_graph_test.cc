#include "pose_graph/part_graph.h"

#include <gmock/gmock.h>

#include "pose_graph/internal/optimise_pose_graph.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

using testing::ElementsAre;

// Five frames at random, each measured against the one before.
class PartGraphTest : public testing::Test {
 protected:
  PartGraphTest() {
    for (int i = 0; i < 5; ++i) {
      OdometryFrame frame{.stamp_ns = 10 * i, .world_from_left = random_.Motion(1.0)};
      frame.reference = std::max(0, i - 1);
      frame.step_covariance = 1e-4 * Matrix6d::Identity();
      odometry_.push_back(frame);
      poses_.emplace_back(frame.world_from_left);
    }
  }

  SeededRandom random_;
  Odometry odometry_;
  std::vector<std::optional<Rigid3>> poses_;
};

TEST_F(PartGraphTest, HasANodePerPosedFrameAndStridesOverTheOthers) {
  poses_[2].reset();
  const PartGraph part = BuildPartGraph(poses_, odometry_, {});
  EXPECT_THAT(part.frames, ElementsAre(0, 1, 3, 4));
  EXPECT_EQ(part.graph.nodes[2].stamp_ns, 30);
  ASSERT_EQ(part.graph.edges.size(), 3U);
  const PoseEdge& stride = part.graph.edges[1];
  EXPECT_EQ(stride.a, 1);
  EXPECT_EQ(stride.b, 2);
  // Two steps know less than one.
  EXPECT_LT(stride.Information()(5, 5), part.graph.edges[0].Information()(5, 5));
}

TEST_F(PartGraphTest, StepsKeepTheMotionOfThePosesGiven) {
  for (auto& pose : poses_) pose = *pose * random_.Motion(0.1);
  const PartGraph part = BuildPartGraph(poses_, odometry_, {});
  for (const PoseEdge& edge : part.graph.edges) {
    EXPECT_EQ(edge.kind, PoseEdgeKind::kOdometry);
    EXPECT_LT(ErrorSigmas(edge, part.graph), 1e-9);
  }
}

TEST_F(PartGraphTest, WhatAnAdjustmentKnowsOfAStepCountsInstead) {
  poses_[2].reset();
  const Matrix6d known = 1e-8 * Vector6d::LinSpaced(1.0, 2.0).asDiagonal();
  const std::vector<std::optional<Matrix6d>> adjusted_steps{std::nullopt, known, known, known,
                                                            std::nullopt};
  const PartGraph without = BuildPartGraph(poses_, odometry_, {});
  const PartGraph with = BuildPartGraph(poses_, odometry_, {}, adjusted_steps);
  ASSERT_EQ(with.graph.edges.size(), 3U);
  EXPECT_LT((with.graph.edges[0].Information() * known - Matrix6d::Identity()).norm(), 1e-3);
  // The stride over frame 2 is no single step, and of the last one nothing is known.
  for (const int i : {1, 2}) {
    EXPECT_EQ(with.graph.edges[i].Information(), without.graph.edges[i].Information());
  }
}

TEST_F(PartGraphTest, ALoopClosureIsAnEdgeWhereBothFramesHaveAPose) {
  poses_[3].reset();
  const Rigid3 there_from_here = random_.Motion(1.0);
  const Matrix6d covariance = 1e-4 * Matrix6d::Identity();
  const PartGraph part = BuildPartGraph(
      poses_, odometry_,
      {{0, 3, there_from_here, covariance, false}, {0, 4, there_from_here, covariance, false}});
  const PoseEdge& closure = part.graph.edges.back();
  EXPECT_EQ(part.graph.edges.size(), 4U);
  EXPECT_EQ(closure.kind, PoseEdgeKind::kLoopClosure);
  EXPECT_EQ(part.frames[closure.b], 4);
  EXPECT_EQ(closure.b_from_a.translation, there_from_here.translation);
  EXPECT_LT(closure.Information()(0, 0), 1e4);
}

}  // namespace
}  // namespace rigmap
