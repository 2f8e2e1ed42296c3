#include "adjustment/internal/datum_frames.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::ElementsAre;

void AddPoints(int count, const std::vector<int>& frames, std::vector<AdjustedPoint>& points) {
  AdjustedPoint point;
  for (int frame : frames) point.observations.push_back({.frame = frame});
  points.insert(points.end(), count, point);
}

TEST(DatumFrames, WithoutPointsEveryFrameIsItsOwn) {
  EXPECT_THAT(DatumFrames({}, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(DatumFrames({}, 0), ElementsAre());
}

TEST(DatumFrames, AChainHangsOnItsFirst) {
  std::vector<AdjustedPoint> points;
  AddPoints(20, {4, 5}, points);
  AddPoints(20, {2, 3}, points);
  AddPoints(20, {3, 4}, points);
  EXPECT_THAT(DatumFrames(points, 7), ElementsAre(0, 1, 2, 2, 2, 2, 6));
}

TEST(DatumFrames, GroupsThatShareNextToNothingStayApart) {
  std::vector<AdjustedPoint> points;
  AddPoints(50, {0, 1, 2}, points);
  AddPoints(5, {2, 3}, points);
  AddPoints(50, {3, 4}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 3, 3));
  AddPoints(1, {2, 3}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 0, 0));
}

TEST(DatumFrames, WhatGroupsShareAddsUpOverTheirFrames) {
  std::vector<AdjustedPoint> points;
  AddPoints(50, {0, 1, 2}, points);
  AddPoints(50, {3, 4}, points);
  AddPoints(2, {0, 3}, points);
  AddPoints(2, {1, 3}, points);
  AddPoints(2, {2, 4}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 0, 0));
}

TEST(SplitBetweenGroups, EachGroupKeepsWhatItSeesAsAPointOfItsOwn) {
  std::vector<AdjustedPoint> points;
  AddPoints(10, {0, 1}, points);
  AddPoints(5, {0, 1, 2, 3}, points);  // too few to tie 2 and 3 to the others
  AddPoints(10, {2, 3}, points);
  const std::vector<int> before = DatumFrames(points, 4);
  ASSERT_THAT(before, ElementsAre(0, 0, 2, 2));
  SplitBetweenGroups(4, points);
  EXPECT_EQ(points.size(), 30u);
  std::size_t observations = 0;
  for (const AdjustedPoint& point : points) {
    observations += point.observations.size();
    for (const PointObservation& o : point.observations) {
      EXPECT_EQ(before[o.frame], before[point.observations.front().frame]);
    }
  }
  EXPECT_EQ(observations, 60u);
  EXPECT_EQ(DatumFrames(points, 4), before);
}

}  // namespace
}  // namespace rigmap
