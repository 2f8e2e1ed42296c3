#include "dead_reckoning/contradictions.h"

#include <gmock/gmock.h>

#include "tests/dead_reckoning/driven_rover.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kDriven = 30;

class FlatContradictionsTest : public testing::Test {
 protected:
  // As images tell it that show where the rover is, but for frames in which they show it standing.
  Odometry Seen(int hung_first, int hung_end) const {
    return ChainedOdometry(rover_, [&](int i) {
      return i >= hung_first && i < hung_end ? Rigid3() : TrueMotion(rover_, i);
    });
  }

  DrivenRover rover_ = DriveRover(kDriven, [](double) { return Drive{0.2, 0.15}; });
};

TEST_F(FlatContradictionsTest, AreNoneWhereImagesAreRight) {
  const auto found = FlatContradictions(rover_.dataset, Seen(0, 0), WithoutSlip(), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->steps, kDriven - 1);
  EXPECT_THAT(found->frames, IsEmpty());
}

TEST_F(FlatContradictionsTest, AreWhereTheCameraHung) {
  const auto found = FlatContradictions(rover_.dataset, Seen(12, 20), WithoutSlip(), {});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->frames, ElementsAre(12, 13, 14, 15, 16, 17, 18, 19));
}

// Their metres are another rover's, a fifth longer: no flat contradiction of any step.
TEST_F(FlatContradictionsTest, AreNotOfWheelsThatAreSomewhatOff) {
  DeadReckoningOptions larger = WithoutSlip();
  larger.wheel_radius_m *= 1.2;
  const auto found = FlatContradictions(rover_.dataset, Seen(0, 0), larger, {});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->frames, IsEmpty());
}

TEST_F(FlatContradictionsTest, AreNotAskedForWithoutSensors) {
  rover_.dataset.wheels = {{}, "odometry.txt: not there"};
  EXPECT_FALSE(FlatContradictions(rover_.dataset, Seen(12, 20), WithoutSlip(), {}));
}

}  // namespace
}  // namespace rigmap
