#include "fusion/internal/covering_views.h"

#include <gmock/gmock.h>

#include <numeric>

#include "tests/fusion/seen_ground.h"

namespace rigmap {
namespace {

using testing::ElementsAre;

// Frames along x, by the metres they are at; of the first what it sees.
struct Drive {
  std::vector<Rigid3> world_from_left;
  DepthView own;
  std::vector<std::size_t> candidates;

  explicit Drive(const std::vector<double>& at_m) {
    SeededRandom random;
    for (const double x_m : at_m) world_from_left.push_back(WorldFromLeft(x_m));
    own.map = GroundSeenFrom(world_from_left.front(), {}, random);
    own.world_from_rectified = world_from_left.front() * own.map.left_from_rectified;
    candidates.resize(at_m.size() - 1);
    std::iota(candidates.begin(), candidates.end(), std::size_t{1});
  }

  std::vector<std::size_t> Covering(std::size_t count) const {
    return CoveringViews(own, candidates, world_from_left, count);
  }
};

TEST(CoveringViewsTest, AreTheNearestWhereTheseShowAll) {
  // Each frame further back shows all that the first does.
  EXPECT_THAT(Drive({0.0, -0.1, -0.2, -0.3, -0.4, -0.5}).Covering(3), ElementsAre(1, 2, 3));
}

TEST(CoveringViewsTest, AreAlsoFurtherOnesThatShowWhatNoneOfTheNearestDoes) {
  // Half a metre ahead the nearest ground is out of view; from behind it is in view again.
  const Drive drive({0.0, 0.5, 0.52, 0.54, 0.56, -0.9, -1.0});
  EXPECT_THAT(drive.Covering(4), ElementsAre(1, 2, 3, 5));
  EXPECT_THAT(drive.Covering(2), ElementsAre(1, 5));
  EXPECT_THAT(drive.Covering(1), ElementsAre(1)) << "the nearest half comes first";
}

TEST(CoveringViewsTest, KeepToTheirNumberAndToWhatThereIs) {
  const Drive drive({0.0, 0.5, 0.52});
  EXPECT_THAT(drive.Covering(8), ElementsAre(1, 2));
  EXPECT_THAT(drive.Covering(0), testing::IsEmpty());
  EXPECT_THAT(CoveringViews(drive.own, {}, drive.world_from_left, 8), testing::IsEmpty());
}

}  // namespace
}  // namespace rigmap
