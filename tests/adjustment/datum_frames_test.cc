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
  AddPoints(9, {2, 3}, points);
  AddPoints(50, {3, 4}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 3, 3));
  AddPoints(1, {2, 3}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 0, 0));
}

TEST(DatumFrames, WhatGroupsShareAddsUpOverTheirFrames) {
  std::vector<AdjustedPoint> points;
  AddPoints(50, {0, 1, 2}, points);
  AddPoints(50, {3, 4}, points);
  AddPoints(4, {0, 3}, points);
  AddPoints(4, {1, 3}, points);
  AddPoints(4, {2, 4}, points);
  EXPECT_THAT(DatumFrames(points, 5), ElementsAre(0, 0, 0, 0, 0));
}

}  // namespace
}  // namespace rigmap
