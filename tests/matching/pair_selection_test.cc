#include "matching/internal/pair_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "tests/support/rover_correspondences.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using Points = std::vector<std::vector<Eigen::Vector3d>>;

// Points before each left camera, none of which depends on the frame.
Points PointsBefore(std::size_t frames) {
  std::vector<Eigen::Vector3d> points;
  for (double x : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
    for (double z : {2.0, 3.0, 4.5}) points.emplace_back(x * z / 2.0, 0.5, z);
  }
  return Points(frames, points);
}

Odometry OdometryOn(const std::vector<Rigid3>& path) {
  Odometry odometry;
  for (const Rigid3& pose : path) {
    odometry.push_back({.world_from_left = path.front().Inverse() * pose, .keyframe = true});
  }
  return odometry;
}

// Once around a circle to the left and over the start again.
std::vector<Rigid3> Loop(int frames_around, int frames) {
  constexpr double kRadius_m = 4.0;
  std::vector<Rigid3> path;
  for (int i = 0; i < frames; ++i) {
    const double heading = 2.0 * std::numbers::pi * i / frames_around;
    path.push_back(
        RoverPose(kRadius_m * std::sin(heading), kRadius_m * (1.0 - std::cos(heading)), heading));
  }
  return path;
}

std::vector<CandidatePair> Select(const Odometry& odometry, const MatchingOptions& options = {}) {
  return SelectPairs(odometry, PointsBefore(odometry.size()), LocCamRig(), options);
}

bool Contains(const std::vector<CandidatePair>& pairs, int a, int b) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const CandidatePair& pair) { return pair.a == a && pair.b == b; });
}

void ExpectOrderedAndUnique(const std::vector<CandidatePair>& pairs) {
  std::set<std::pair<int, int>> seen;
  for (const CandidatePair& pair : pairs) {
    EXPECT_LT(pair.a, pair.b);
    EXPECT_TRUE(seen.emplace(pair.a, pair.b).second) << pair.a << " " << pair.b;
  }
}

TEST(SelectPairs, GivesEachKeyframeItsNeighbours) {
  const Odometry odometry = OdometryOn(Loop(400, 12));
  MatchingOptions options;
  options.neighbours = 3;
  options.max_revisits = 0;
  const auto pairs = Select(odometry, options);
  ExpectOrderedAndUnique(pairs);
  EXPECT_EQ(pairs.size(), 0u + 1 + 2 + 9 * 3);
  for (int b = 3; b < 12; ++b) {
    for (int a = b - 3; a < b; ++a) EXPECT_TRUE(Contains(pairs, a, b));
  }
  // Nearest first, in order of b.
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    EXPECT_GE(pairs[i].b, pairs[i - 1].b);
    if (pairs[i].b == pairs[i - 1].b) {
      EXPECT_LT(pairs[i].a, pairs[i - 1].a);
    }
  }
}

TEST(SelectPairs, ProposesALoopClosure) {
  const Odometry odometry = OdometryOn(Loop(24, 27));
  const auto pairs = Select(odometry);
  ExpectOrderedAndUnique(pairs);
  for (int again : {24, 25, 26}) EXPECT_TRUE(Contains(pairs, again - 24, again)) << again;
  const MatchingOptions options;
  for (int b = 0; b < 27; ++b) {
    const auto loop_closures =
        std::count_if(pairs.begin(), pairs.end(),
                      [&](const CandidatePair& pair) { return pair.b == b && pair.loop_closure; });
    EXPECT_LE(loop_closures, options.max_revisits);
  }
  // The other side of the circle is not in view.
  EXPECT_FALSE(Contains(pairs, 0, 12));
  for (const CandidatePair& pair : pairs) {
    EXPECT_EQ(pair.loop_closure, pair.b - pair.a > options.neighbours);
  }
}

TEST(SelectPairs, ProposesNoLoopClosureWhereTheRoverFacesTheOtherWay) {
  std::vector<Rigid3> path = Loop(400, 10);
  for (int i = 9; i >= 0; --i) {  // back along the same track
    Rigid3 turned = path[i];
    turned.rotation =
        Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()) * turned.rotation;
    path.push_back(turned);
  }
  for (const CandidatePair& pair : Select(OdometryOn(path))) {
    EXPECT_FALSE(pair.loop_closure && pair.a < 10 && pair.b >= 10) << pair.a << " " << pair.b;
  }
}

TEST(SelectPairs, TiesOtherFramesToTheKeyframesAroundThem) {
  Odometry odometry = OdometryOn(Loop(400, 9));
  for (int i : {1, 2, 4, 8}) odometry[i].keyframe = false;
  const auto pairs = Select(odometry);
  ExpectOrderedAndUnique(pairs);
  std::set<std::pair<int, int>> others;
  for (const CandidatePair& pair : pairs) {
    if (!odometry[pair.a].keyframe || !odometry[pair.b].keyframe) others.emplace(pair.a, pair.b);
  }
  EXPECT_EQ(others, (std::set<std::pair<int, int>>{
                        {0, 1}, {1, 3}, {0, 2}, {2, 3}, {3, 4}, {4, 5}, {7, 8}}));
  // After both keyframes have been matched with those before them, and before the next one.
  const auto index_of = [&](int a, int b) {
    return std::find_if(pairs.begin(), pairs.end(),
                        [&](const CandidatePair& pair) { return pair.a == a && pair.b == b; });
  };
  EXPECT_LT(index_of(0, 3), index_of(0, 1));
  EXPECT_LT(index_of(2, 3), index_of(3, 5));
  EXPECT_LT(index_of(3, 5), index_of(4, 5));
}

TEST(SelectPairs, FewFramesAndNoPoints) {
  EXPECT_TRUE(Select({}).empty());
  EXPECT_TRUE(Select(OdometryOn(Loop(24, 1))).empty());
  const Odometry odometry = OdometryOn(Loop(24, 27));
  for (const auto& pair : SelectPairs(odometry, Points(27), LocCamRig(), {})) {
    EXPECT_FALSE(pair.loop_closure);
  }
}

}  // namespace
}  // namespace rigmap
