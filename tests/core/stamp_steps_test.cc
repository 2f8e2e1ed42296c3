#include "core/stamp_steps.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(StampStepsTest, AStepOfMoreThanTwoAndAHalfIsAGap) {
  const StampSteps steps = StepsOf({0, 100, 200, 450, 550, 801, 901});
  EXPECT_EQ(steps.usual_ns, 100);
  EXPECT_THAT(steps.gaps, ElementsAre(4));  // 251; 250 are not
}

TEST(StampStepsTest, FewerThanTwoStampsHaveNone) {
  for (const std::vector<StampNs>& stamps : {std::vector<StampNs>{}, {7}}) {
    EXPECT_EQ(StepsOf(stamps).usual_ns, 0);
    EXPECT_THAT(StepsOf(stamps).gaps, IsEmpty());
  }
}

}  // namespace
}  // namespace rigmap
