#include "workflows/stages/depth_consistency_report.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

DepthConsistency SomeConsistency() {
  DepthConsistency consistency{.ring_width_px = 100.0};
  consistency.radius.regions.resize(DepthConsistency::kRings);
  consistency.cells.regions.resize(DepthConsistency::kRows * DepthConsistency::kColumns);
  consistency.radius.depth_pct = {0.3, 0.1};
  consistency.cells.disparity_px = {0.04, 0.01};
  consistency.cells.regions[6] = RegionDifference{25, {-0.05, 0.02}, {0.7, 0.2}};
  return consistency;
}

TEST(ReportDepthConsistency, SaysNothingOfNothing) {
  EXPECT_TRUE(ReportDepthConsistency(std::nullopt).is_null());
}

TEST(ReportDepthConsistency, NamesRingsAndCells) {
  const Report report = ReportDepthConsistency(SomeConsistency());
  const Report &radius = report.at("radius"), &cells = report.at("place");
  EXPECT_EQ(radius.at("systematic_pct"), 0.3);
  EXPECT_EQ(radius.at("systematic_sigma_pct"), 0.1);
  EXPECT_EQ(cells.at("systematic_px"), 0.04);
  EXPECT_EQ(cells.at("systematic_sigma_px"), 0.01);
  ASSERT_EQ(radius.at("rings").size(), 5U);
  EXPECT_EQ(radius.at("rings")[4].at("from_px"), 400.0);
  EXPECT_EQ(radius.at("rings")[4].at("to_px"), 500.0);
  ASSERT_EQ(cells.at("cells").size(), 12U);
  EXPECT_EQ(cells.at("cells")[6], (Report{{"row", 1},
                                          {"column", 2},
                                          {"tracks", 25},
                                          {"disparity_px", -0.05},
                                          {"disparity_sigma_px", 0.02},
                                          {"depth_pct", 0.7},
                                          {"depth_sigma_pct", 0.2}}));
}

TEST(ReportDepthConsistency, GivesRegionsOfFewTracksAsNull) {
  const Report report = ReportDepthConsistency(SomeConsistency());
  const Report& ring = report.at("radius").at("rings")[0];
  for (const char* key :
       {"tracks", "disparity_px", "disparity_sigma_px", "depth_pct", "depth_sigma_pct"}) {
    EXPECT_TRUE(ring.at(key).is_null()) << key;
  }
}

}  // namespace
}  // namespace rigmap
