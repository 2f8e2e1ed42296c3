// How much memory dense matching may take.
#include <gmock/gmock.h>

#include "core/error.h"
#include "dense/dense_matcher.h"
#include "dense/seen_depths.h"
#include "tests/support/message_of.h"
#include "tests/support/simulated_part.h"
#include "workflows/stages/dense_memory.h"
#include "workflows/stages/features.h"
#include "workflows/stages/fusion.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kNearest_m = 0.5;

TEST(FramesAtOnceTest, AreAsManyAsFitOrThereAreThreads) {
  EXPECT_EQ(FramesAtOnce(100.0, kNearest_m, {350.0, 1000, 8}), 3);
  EXPECT_EQ(FramesAtOnce(100.0, kNearest_m, {350.0, 1000, 2}), 2);
}

// What other parts or the adjustment of a large whole hold is no reason to throw the work away.
TEST(FramesAtOnceTest, IsOneInTheProcessWhereNoneFitsBesideTheRest) {
  EXPECT_EQ(FramesAtOnce(100.0, kNearest_m, {99.0, 1000, 8}), 0);
  EXPECT_EQ(FramesAtOnce(100.0, kNearest_m, {-3000.0, 1000, 8}), 0);
}

TEST(FramesAtOnceTest, IsRefusedWhereOneDoesNotFitByItself) {
  EXPECT_THAT(MessageOf<UsageError>([] {
                FramesAtOnce(900.0, kNearest_m, {1000.0, 1000, 8});
              }),
              AllOf(HasSubstr("--memory: expected at least 1050 MB"), HasSubstr("found 1000"),
                    HasSubstr("more than 0.5 m")));
}

TEST(RequireMemoryForDepthTest, KnowsBeforeAnyFrameIsReadWhatCannotFit) {
  StereoRig rig = SmallRoverRig();
  EXPECT_NO_THROW(RequireMemoryForDepth(rig, {}, {}, 256));
  for (Camera* camera : {&rig.left.camera, &rig.right.camera}) {
    camera->width = 4000;
    camera->height = 3000;
    for (double* length_px : {&camera->fx, &camera->fy, &camera->cx, &camera->cy}) {
      *length_px *= 12.5;
    }
  }
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireMemoryForDepth(rig, {}, {}, 512); }),
              HasSubstr("--memory: expected at least "));
  // However near the things are that the images will show: a wall of stones, say. That a further
  // one needs less is said only where it needs little enough.
  EXPECT_THAT(
      MessageOf<UsageError>([&] { RequireMemoryForDepth(rig, {}, {}, 2048); }),
      AllOf(HasSubstr("--memory: expected at least "), Not(HasSubstr("dense.min_depth_m"))));
  EXPECT_NO_THROW(RequireMemoryForFeatures(rig, 900));
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireMemoryForFeatures(rig, 850); }),
              HasSubstr("--memory: expected at least 894 MB"));
  EXPECT_NO_THROW(RequireMemoryForDepth(rig, {}, {}, 4000));
  const double nearest_m = DepthsSeen(rig, {}, {}).nearest_m;
  const DenseMatcher matcher(rig, nearest_m, {}, {});
  EXPECT_EQ(FramesAtOnce(matcher.MegabytesPerFrame(), nearest_m, {4000.0, 4000, 1}), 1);
}

TEST(RequireMemoryForFusionTest, KnowsBeforeAnyFrameIsReadWhatCannotFit) {
  const FusionOptions options{.neighbours = 8, .ahead = 5};
  EXPECT_NO_THROW(RequireMemoryForFusion(100, 10.0, options, 590));
  EXPECT_THAT(MessageOf<UsageError>([&] { RequireMemoryForFusion(100, 10.0, options, 589); }),
              HasSubstr("--memory: expected at least 590 MB, for 14 depth maps of 10 MB at once, "
                        "found 589"));
  EXPECT_NO_THROW(RequireMemoryForFusion(2, 10.0, options, 470));
}

}  // namespace
}  // namespace rigmap
