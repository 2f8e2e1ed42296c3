#include "pose_graph/relax_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/seeded_random.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

constexpr int kFrames = 100;
using Poses = std::vector<std::optional<Rigid3>>;

std::vector<Rigid3> Circle() {
  std::vector<Rigid3> truth;
  for (int i = 0; i < kFrames; ++i) {
    const double heading = 2.0 * std::numbers::pi * i / (kFrames - 1);
    truth.push_back(RoverPose(3.0 * std::sin(heading), 3.0 * (1.0 - std::cos(heading)), heading));
  }
  return truth;
}

// Every step two per cent too long and off by a twentieth of a degree, and by chance.
Poses Drifted(const std::vector<Rigid3>& truth, SeededRandom& random) {
  Poses poses{truth.front()};
  for (int i = 1; i < kFrames; ++i) {
    Rigid3 step = truth[i - 1].Inverse() * truth[i];
    step.translation = 1.02 * step.translation + random.Noise(0.001);
    const double turn_rad = 0.05 * std::numbers::pi / 180.0;
    step.rotation =
        step.rotation * ExpRotation({0.0, -turn_rad, 0.0}) * ExpRotation(random.Noise(0.0005));
    poses.push_back(*poses.back() * step);
  }
  return poses;
}

Odometry Chain() {
  Odometry odometry(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    odometry[i].reference = std::max(0, i - 1);
    odometry[i].step_covariance = 1e-8 * Matrix6d::Identity();
  }
  return odometry;
}

LoopClosure TrueLoopClosure(const std::vector<Rigid3>& truth, int a, int b) {
  return {a, b, truth[b].Inverse() * truth[a], 1e-6 * Matrix6d::Identity(), true};
}

double WorstError_m(const Poses& poses, const std::vector<Rigid3>& truth) {
  double worst = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    if (poses[i]) {
      worst = std::max(worst, (poses[i]->translation - truth[i].translation).norm());
    }
  }
  return worst;
}

double WorstMove_m(const Poses& one, const Poses& other) {
  double worst = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    worst = std::max(worst, (one[i]->translation - other[i]->translation).norm());
  }
  return worst;
}

TEST(RelaxPoses, AClosingEdgeTakesTheDriftOut) {
  SeededRandom random;
  const auto truth = Circle();
  const Poses start = Drifted(truth, random);
  const Poses relaxed = RelaxPoses(start, Chain(), {TrueLoopClosure(truth, 0, kFrames - 1)});
  EXPECT_GT(WorstError_m(start, truth), 0.25);
  // Two per cent of the diameter stay: no loop tells its own size.
  EXPECT_LT(WorstError_m(relaxed, truth), 0.15);
  const Rigid3 closed = relaxed[kFrames - 1]->Inverse() * *relaxed[0];
  const Rigid3 off = closed * (truth[kFrames - 1].Inverse() * truth[0]).Inverse();
  EXPECT_LT(off.translation.norm(), 0.005);
  EXPECT_LT(AngleOf(off.rotation), 0.002);
  EXPECT_EQ(relaxed[0]->translation, start[0]->translation);
}

TEST(RelaxPoses, OneWrongEdgeBendsNothing) {
  SeededRandom random;
  const auto truth = Circle();
  const Poses start = Drifted(truth, random);
  const LoopClosure right = TrueLoopClosure(truth, 0, kFrames - 1);
  LoopClosure wrong = TrueLoopClosure(truth, 20, 70);
  wrong.b_from_a = {random.Rotation(0.3), wrong.b_from_a.translation + random.Vector(2.0)};
  const Poses with_both = RelaxPoses(start, Chain(), {right, wrong});
  EXPECT_LT(WorstMove_m(with_both, RelaxPoses(start, Chain(), {right})), 1e-4);
  EXPECT_LT(WorstMove_m(RelaxPoses(start, Chain(), {wrong}), start), 1e-12);
}

TEST(RelaxPoses, AgreeingLoopClosuresChangeNothing) {
  const auto truth = Circle();
  const Poses start(truth.begin(), truth.end());
  const Poses relaxed = RelaxPoses(start, Chain(), {TrueLoopClosure(truth, 0, 99)});
  EXPECT_EQ(WorstMove_m(relaxed, start), 0.0);
  EXPECT_EQ(WorstMove_m(RelaxPoses(start, Chain(), {}), start), 0.0);
}

TEST(TakeContradictedTest, TakesTheWrongOnesOut) {
  SeededRandom random;
  const auto truth = Circle();
  Poses poses(truth.begin(), truth.end());
  poses[30].reset();
  LoopClosure wrong = TrueLoopClosure(truth, 20, 70);
  wrong.b_from_a.translation.x() += 0.2;
  std::vector<LoopClosure> loop_closures{TrueLoopClosure(truth, 0, 99), wrong,
                                         TrueLoopClosure(truth, 30, 80)};
  loop_closures[0].b_from_a.translation += random.Vector(0.005);
  const auto contradicted = TakeContradicted(poses, Chain(), loop_closures);
  ASSERT_EQ(contradicted.size(), 1U);
  EXPECT_EQ(contradicted[0].a, 20);
  ASSERT_EQ(loop_closures.size(), 2U);
  EXPECT_EQ(loop_closures[1].a, 30) << "of a frame without a pose nothing is known";
}

TEST(RelaxPoses, FramesWithoutAPoseAreStridden) {
  SeededRandom random;
  const auto truth = Circle();
  Poses start = Drifted(truth, random);
  for (int i : {10, 11, 50}) start[i].reset();
  const std::vector<LoopClosure> loop_closures{
      TrueLoopClosure(truth, 0, 99), TrueLoopClosure(truth, 1, 99), TrueLoopClosure(truth, 10, 90)};
  const Poses relaxed = RelaxPoses(start, Chain(), loop_closures);
  for (int i = 0; i < kFrames; ++i) EXPECT_EQ(relaxed[i].has_value(), start[i].has_value());
  EXPECT_LT(WorstError_m(relaxed, truth), 0.15);
}

TEST(RelaxPoses, MovesWithTheWholePart) {
  SeededRandom random;
  const auto truth = Circle();
  const Poses start = Drifted(truth, random);
  const Rigid3 elsewhere = random.Motion(10.0);
  Poses moved;
  for (const auto& pose : start) moved.push_back(elsewhere * *pose);
  const std::vector<LoopClosure> loop_closures{TrueLoopClosure(truth, 0, 99)};
  const Poses here = RelaxPoses(start, Chain(), loop_closures);
  const Poses there = RelaxPoses(moved, Chain(), loop_closures);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_LT((there[i]->translation - (elsewhere * *here[i]).translation).norm(), 1e-4);
  }
}

// The circle in three pieces, each of its true shape; the later ones lie where a drifting odometry
// has carried them.
struct Pieces {
  std::vector<int> group;  // by their first frame
  Poses poses;
};

Pieces CarriedAlong(const std::vector<Rigid3>& truth) {
  const Rigid3 drift{ExpRotation({0.0, 0.0, 0.02}), {0.05, 0.02, 0.0}};
  Pieces pieces;
  Rigid3 moved;
  for (int i = 0; i < kFrames; ++i) {
    const bool begins = i == 40 || i == 75;
    if (begins) moved = truth[i] * drift * truth[i].Inverse() * moved;
    pieces.group.push_back(i < 40 ? 0 : i < 75 ? 40 : 75);
    pieces.poses.push_back(moved * truth[i]);
  }
  return pieces;
}

TEST(RelaxGroups, ClosesTheLoopAndKeepsTheShapeOfEachGroup) {
  const std::vector<Rigid3> truth = Circle();
  const Pieces pieces = CarriedAlong(truth);
  const Poses relaxed =
      RelaxGroups(pieces.poses, pieces.group, Chain(), {TrueLoopClosure(truth, 2, kFrames - 3)});
  const Rigid3 closed = relaxed[kFrames - 3]->Inverse() * *relaxed[2],
               expected = truth[kFrames - 3].Inverse() * truth[2];
  EXPECT_GT(WorstError_m(pieces.poses, truth), 0.1);
  EXPECT_LT((closed.translation - expected.translation).norm(), 0.01);
  EXPECT_LT(WorstError_m(relaxed, truth), 0.5 * WorstError_m(pieces.poses, truth));
  for (int i = 0; i < kFrames; ++i) {
    const int first = pieces.group[i];
    const Rigid3 kept = relaxed[first]->Inverse() * *relaxed[i],
                 shape = truth[first].Inverse() * truth[i];
    EXPECT_LT((kept.translation - shape.translation).norm(), 1e-9) << i;
  }
}

TEST(RelaxGroups, LeavesGroupsWhereNoLoopClosureTiesThem) {
  const std::vector<Rigid3> truth = Circle();
  const Pieces pieces = CarriedAlong(truth);
  const LoopClosure within = TrueLoopClosure(truth, 2, 30);
  const Poses relaxed = RelaxGroups(pieces.poses, pieces.group, Chain(), {within});
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(relaxed[i]->translation, pieces.poses[i]->translation) << i;
  }
}

}  // namespace
}  // namespace rigmap
