#include "trajectory/lost_frames.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Ten frames, each measured against the one before but for those that `predicted` names.
Odometry Frames(const std::vector<int>& predicted) {
  Odometry odometry(10);
  for (int i = 0; i < 10; ++i) {
    odometry[i].reference = std::max(0, i - 1);
    odometry[i].source = PoseSource::kOdometry;
  }
  for (const int i : predicted) odometry[i].source = PoseSource::kPredicted;
  return odometry;
}

TEST(LostFrames, AreThoseThatAllBehindThemHangOn) {
  EXPECT_THAT(LostFrames(Frames({})), IsEmpty());
  EXPECT_THAT(LostFrames(Frames({3, 4})), ElementsAre(3, 4));
  EXPECT_THAT(LostFrames(Frames({3, 5, 6})), ElementsAre(3, 5, 6));
}

TEST(LostFrames, ARunThatIsHeldFromBothSidesIsNotLost) {
  Odometry odometry = Frames({3, 4, 7});
  odometry[5].reference = 2;
  EXPECT_THAT(LostFrames(odometry), ElementsAre(7));
}

TEST(LostFrames, BehindTheLastMeasuredOneAllAre) {
  EXPECT_THAT(LostFrames(Frames({8, 9})), ElementsAre(8, 9));
}

TEST(LostFrames, ThoseBeforeTheFirstMeasuredOneHangOnIt) {
  Odometry odometry = Frames({0, 1});
  odometry[0].reference = 1;
  odometry[1].reference = 2;
  odometry[2].reference = 2;
  EXPECT_THAT(LostFrames(odometry), IsEmpty());
}

}  // namespace
}  // namespace rigmap
