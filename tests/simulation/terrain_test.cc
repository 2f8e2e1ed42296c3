#include "simulation/terrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rigmap {
namespace {

TEST(Terrain, IsTheSameForTheSameSeedOnly) {
  const Terrain one({.seed = 7}), same({.seed = 7}), other({.seed = 8});
  double difference_m = 0.0;
  for (double east_m = -20.0; east_m < 20.0; east_m += 0.7) {
    EXPECT_EQ(one.Height(east_m, 3.0), same.Height(east_m, 3.0));
    difference_m =
        std::max(difference_m, std::abs(one.Height(east_m, 3.0) - other.Height(east_m, 3.0)));
  }
  EXPECT_GT(difference_m, 0.05);
}

TEST(Terrain, IsFlatWithoutAmplitudes) {
  const Terrain flat({.undulation_m = 0.0,
                      .ripple_m = 0.0,
                      .roughness_m = 0.0,
                      .footprint_trails = 0.0,
                      .tyre_tracks = 0.0});
  for (double north_m = -30.0; north_m < 30.0; north_m += 1.3) {
    EXPECT_NEAR(flat.Height(5.0, north_m), 0.0, 1e-9);
  }
}

TEST(Terrain, RisesToDunesInTheEastAndFallsBelowTheSeaInTheWest) {
  const Terrain beach({});
  const double hinterland_m = TerrainOptions{}.hinterland_m;
  EXPECT_GT(beach.Height(hinterland_m + 60.0, 0.0), 0.5);
  EXPECT_LT(beach.Height(-hinterland_m - 60.0, 0.0), Terrain::kSeaLevel_m);
}

TEST(Terrain, ACoarseMeshLosesWhatItCannotShow) {
  const Terrain rippled({.undulation_m = 0.0,
                         .ripple_m = 0.02,
                         .roughness_m = 0.0,
                         .footprint_trails = 0.0,
                         .tyre_tracks = 0.0});
  const auto relief_m = [&](double cell_m) {
    double most = 0.0;
    for (double east_m = 0.0; east_m < 3.0; east_m += 0.01) {
      most = std::max(most, std::abs(rippled.Height(east_m, 0.0, cell_m)));
    }
    return most;
  };
  EXPECT_GT(relief_m(0.0), 0.01);
  EXPECT_LT(relief_m(1.0), 1e-6);
}

}  // namespace
}  // namespace rigmap
