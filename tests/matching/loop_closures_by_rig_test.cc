#include "matching/loop_closures_by_rig.h"

#include <gtest/gtest.h>

#include "tests/matching/circling_rover.h"

namespace rigmap {
namespace {

// Of the way that each closure says.
double WorstError_m(const SyntheticRover& rover, const std::vector<LoopClosure>& loop_closures) {
  double worst_m = 0.0;
  for (const LoopClosure& loop_closure : loop_closures) {
    const Rigid3 error = loop_closure.b_from_a * TrueMotion(rover, loop_closure).Inverse();
    worst_m = std::max(worst_m, error.translation.norm());
  }
  return worst_m;
}

class LoopClosuresByRigTest : public testing::Test {
 protected:
  // The right eye turned by two pixels of disparity.
  StereoRig TurnedRig() const {
    StereoRig rig = rover_.rig;
    const Rigid3 turn{ExpRotation({0.0, 2.0 / rig.left.camera.fx, 0.0}), Eigen::Vector3d::Zero()};
    rig.right_from_left = turn * rig.right_from_left;
    return rig;
  }

  SyntheticRover rover_ = CircleAndOn();
  MatchingOptions options_;
};

TEST_F(LoopClosuresByRigTest, FreesThemOfTheErrorsOfAWrongRig) {
  SyntheticRover by_wrong = rover_;
  by_wrong.rig = TurnedRig();
  const Correspondences matches = MatchRover(by_wrong, Drifting(by_wrong), options_);
  ASSERT_GE(matches.loop_closures.size(), 3u);
  EXPECT_GT(WorstError_m(rover_, matches.loop_closures), 0.06);
  const auto anew = LoopClosuresByRig(matches, rover_.rig, options_);
  EXPECT_EQ(anew.size(), matches.loop_closures.size());
  EXPECT_LT(WorstError_m(rover_, anew), 0.02);
}

TEST_F(LoopClosuresByRigTest, LeavesOutThoseThatNoMotionOfTheRigAgreesWith) {
  Correspondences matches = MatchRover(rover_, Drifting(rover_), options_);
  ASSERT_GE(matches.loop_closures.size(), 3u);
  const LoopClosure torn = matches.loop_closures.front();
  for (FramePair& pair : matches.pairs) {
    if (pair.a == torn.a && pair.b == torn.b) {
      pair.matches.resize(static_cast<std::size_t>(options_.verification.min_inliers) - 1);
    }
  }
  const auto anew = LoopClosuresByRig(matches, rover_.rig, options_);
  EXPECT_EQ(anew.size() + 1, matches.loop_closures.size());
  for (const LoopClosure& kept : anew) EXPECT_FALSE(kept.a == torn.a && kept.b == torn.b);
}

}  // namespace
}  // namespace rigmap
