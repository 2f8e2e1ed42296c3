#include "scale/baseline_scale.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "tests/support/rover_correspondences.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr ImageRef Left(int keyframe) { return {keyframe, Eye::kLeft}; }
constexpr ImageRef Right(int keyframe) { return {keyframe, Eye::kRight}; }

SparseImage ImageOf(const ImageRef& ref, const Rigid3& camera_from_world,
                    const Sim3& model_from_world) {
  SparseImage image{.ref = ref};
  image.camera_from_model = TransformPose(model_from_world, camera_from_world.Inverse()).Inverse();
  return image;
}

// The rover's keyframes first to end - 1 as COLMAP poses them in a gauge of its own.
SparseModel ModelOf(const SyntheticRover& rover, int first, int end, const Sim3& model_from_world) {
  SparseModel model;
  for (int k = first; k < end; ++k) {
    const Rigid3 left_from_world = rover.world_from_left[k].Inverse();
    model.images.push_back(ImageOf(Left(k), left_from_world, model_from_world));
    model.images.push_back(
        ImageOf(Right(k), rover.rig.right_from_left * left_from_world, model_from_world));
  }
  return model;
}

// Moves a camera aside, along its own x axis.
void Shift(SparseModel& model, const ImageRef& ref, double model_units) {
  for (SparseImage& image : model.images) {
    if (image.ref == ref) image.camera_from_model.translation.x() += model_units;
  }
}

void ExpectSamePath(const std::vector<std::optional<Rigid3>>& found,
                    const std::vector<Rigid3>& expected, double tolerance_m, double tolerance_rad) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    ASSERT_TRUE(found[k]) << k;
    const Rigid3 difference = found[k]->Inverse() * expected[k];
    EXPECT_LT(difference.translation.norm(), tolerance_m) << k;
    EXPECT_LT(AngleOf(difference.rotation), tolerance_rad) << k;
  }
}

// By the scales of their own pairs.
AlignedKeyframes Align(const std::vector<SparseModel>& models, const std::vector<Rigid3>& odometric,
                       const StereoRig& rig, const ScaleOptions& options) {
  return AlignModels(models, MeasureBaselines(models, rig.Baseline(), options), odometric);
}

class BaselineScaleTest : public testing::Test {
 protected:
  SyntheticRover rover_ = MakeSyntheticRover({.frames = 12, .points_per_m2 = 0.0});
  double baseline_m_ = rover_.rig.Baseline();
  ScaleOptions options_;
  SeededRandom random_;
};

TEST_F(BaselineScaleTest, ScalesInverselyWithTheGauge) {
  for (int trial = 0; trial < 20; ++trial) {
    const Sim3 model_from_world = random_.Similarity(50.0);
    const SparseModel model = ModelOf(rover_, 0, 12, model_from_world);
    const auto scale = MeasureBaseline(model, baseline_m_, options_);
    ASSERT_TRUE(scale);
    EXPECT_NEAR(scale->metres_per_model_unit * model_from_world.scale, 1.0, 1e-9);
    EXPECT_LT(scale->relative_spread, 1e-9);
    EXPECT_EQ(scale->pairs_used.size(), 12u);
    EXPECT_THAT(scale->pairs_rejected, IsEmpty());
  }
}

TEST_F(BaselineScaleTest, HalvingTheModelDoublesTheFactorAndKeepsTheRest) {
  SparseModel model = ModelOf(rover_, 0, 12, random_.Similarity(5.0));
  for (int k = 0; k < 12; ++k) Shift(model, Right(k), random_.Normal(0.001));
  Shift(model, Right(4), 0.5);
  SparseModel half = model;
  for (SparseImage& image : half.images) image.camera_from_model.translation *= 0.5;
  const auto whole_scale = MeasureBaseline(model, baseline_m_, options_);
  const auto half_scale = MeasureBaseline(half, baseline_m_, options_);
  ASSERT_TRUE(whole_scale && half_scale);
  EXPECT_NEAR(half_scale->metres_per_model_unit / whole_scale->metres_per_model_unit, 2.0, 1e-12);
  EXPECT_NEAR(half_scale->relative_spread, whole_scale->relative_spread, 1e-12);
  EXPECT_EQ(half_scale->pairs_used, whole_scale->pairs_used);
  EXPECT_THAT(half_scale->pairs_rejected, ElementsAre(4));
}

TEST_F(BaselineScaleTest, WildPairsAreListedAndDoNotMoveTheScale) {
  SparseModel model = ModelOf(rover_, 0, 12, Sim3());
  Shift(model, Right(3), 0.3);
  Shift(model, Left(7), -0.05);
  Shift(model, Right(8), -2.0);
  const auto scale = MeasureBaseline(model, baseline_m_, options_);
  ASSERT_TRUE(scale);
  EXPECT_THAT(scale->pairs_rejected, ElementsAre(3, 7, 8));
  EXPECT_THAT(scale->pairs_used, ElementsAre(0, 1, 2, 4, 5, 6, 9, 10, 11));
  EXPECT_NEAR(scale->metres_per_model_unit, 1.0, 1e-9);
}

TEST_F(BaselineScaleTest, TheSpreadIsTakenBeforeAnyPairIsRejected) {
  // The median of these is 1.1 (of those that stay, 1.05), the median deviation 0.1.
  SparseModel model = ModelOf(rover_, 0, 12, Sim3());
  const std::vector<double> factors{1, 1, 1, 1, 1, 1.05, 1.1, 1.1, 1.3, 1.3, 3, 3};
  for (int k = 0; k < 12; ++k) {
    SparseImage& right = model.images[2 * k + 1];
    Rigid3 right_from_left = rover_.rig.right_from_left;
    right_from_left.translation = factors[k] * (right_from_left.translation);
    right.camera_from_model = right_from_left * model.images[2 * k].camera_from_model;
  }
  const auto scale = MeasureBaseline(model, baseline_m_, {.max_sigmas = 2.0});
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->relative_spread, 1.4826 * 0.1 / 1.1, 1e-9);
  EXPECT_THAT(scale->pairs_rejected, ElementsAre(10, 11));
  EXPECT_NEAR(scale->metres_per_model_unit, 1.0 / 1.05, 1e-9);
}

TEST_F(BaselineScaleTest, APairWithinTheToleratedShareIsKeptHoweverSmallTheSpread) {
  SparseModel model = ModelOf(rover_, 0, 12, Sim3());
  Shift(model, Right(5), -0.009 * baseline_m_);
  EXPECT_THAT(MeasureBaseline(model, baseline_m_, options_)->pairs_rejected, IsEmpty());
  Shift(model, Right(5), -0.009 * baseline_m_);
  EXPECT_THAT(MeasureBaseline(model, baseline_m_, options_)->pairs_rejected, ElementsAre(5));
}

TEST_F(BaselineScaleTest, WithoutAStereoPairThereIsNoScale) {
  EXPECT_FALSE(MeasureBaseline({}, baseline_m_, options_));
  SparseModel model = ModelOf(rover_, 0, 12, Sim3());
  std::erase_if(model.images, [](const SparseImage& image) {  // right of even, left of odd ones
    return (image.ref.eye == Eye::kRight) == (image.ref.frame % 2 == 0);
  });
  ASSERT_EQ(model.images.size(), 12u);
  EXPECT_FALSE(MeasureBaseline(model, baseline_m_, options_));
}

TEST_F(BaselineScaleTest, OneModelIsLaidOnTheOdometry) {
  const Rigid3 moved = random_.Motion(100.0);
  std::vector<Rigid3> odometric, expected;
  for (const Rigid3& pose : rover_.world_from_left) expected.push_back(moved * pose);
  odometric.assign(12, random_.Motion(5.0));  // only the first keyframe's counts
  odometric[0] = expected[0];
  const Sim3 model_from_world = random_.Similarity(20.0);
  const auto aligned =
      Align({ModelOf(rover_, 0, 12, model_from_world)}, odometric, rover_.rig, options_);
  ExpectSamePath(aligned.world_from_left, expected, 1e-9, 1e-7);
  ASSERT_EQ(aligned.models.size(), 1u);
  EXPECT_EQ(aligned.models[0].keyframes.size(), 12u);
  const Sim3 round = aligned.models[0].world_from_model * model_from_world;
  EXPECT_NEAR(round.scale, 1.0, 1e-9);
  EXPECT_LT((round.translation - moved.translation).norm(), 1e-7);  // m
}

TEST_F(BaselineScaleTest, TwoModelsOfDifferentGaugesMakeOnePath) {
  for (int trial = 0; trial < 10; ++trial) {
    const SparseModel first = ModelOf(rover_, 0, 5, random_.Similarity(20.0));
    const SparseModel second = ModelOf(rover_, 6, 12, random_.Similarity(20.0));
    for (const auto& models : {std::vector{first, second}, std::vector{second, first}}) {
      const auto aligned = Align(models, rover_.world_from_left, rover_.rig, options_);
      ASSERT_EQ(aligned.models.size(), 2u);
      EXPECT_FALSE(aligned.world_from_left[5]);
      auto found = aligned.world_from_left;
      found[5] = rover_.world_from_left[5];
      ExpectSamePath(found, rover_.world_from_left, 1e-9, 1e-7);
    }
  }
}

TEST_F(BaselineScaleTest, ASecondModelHangsOnTheNearestKeyframeOfTheFirst) {
  // Odometry that errs everywhere but from keyframe 5 to 6.
  auto odometric = DriftingPoses(rover_, 0.05, 0.02, random_);
  odometric[0] = rover_.world_from_left[0];
  odometric[6] = odometric[5] * (rover_.world_from_left[5].Inverse() * rover_.world_from_left[6]);
  const auto aligned = Align({ModelOf(rover_, 0, 6, random_.Similarity(9.0)),
                              ModelOf(rover_, 6, 12, random_.Similarity(9.0))},
                             odometric, rover_.rig, options_);
  ExpectSamePath(aligned.world_from_left, rover_.world_from_left, 1e-9, 1e-7);
}

TEST_F(BaselineScaleTest, WhereModelsOverlapTheEarlierStays) {
  SparseModel second = ModelOf(rover_, 5, 12, random_.Similarity(20.0));
  const double unit = MeasureBaseline(second, 1.0, options_)->metres_per_model_unit;
  for (int k : {5, 6}) {  // both eyes aside by about as much as they are apart
    Shift(second, Left(k), 1.0 / unit);
    Shift(second, Right(k), 1.0 / unit);
  }
  const auto aligned = Align({ModelOf(rover_, 0, 8, random_.Similarity(20.0)), second},
                             rover_.world_from_left, rover_.rig, options_);
  EXPECT_THAT(aligned.models[0].keyframes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(aligned.models[1].keyframes, ElementsAre(8, 9, 10, 11));
  for (int k = 0; k < 8; ++k) {
    EXPECT_LT(
        (aligned.world_from_left[k]->translation - rover_.world_from_left[k].translation).norm(),
        1e-9);  // m
  }
}

TEST_F(BaselineScaleTest, AWildPairDoesNotCarryAModel) {
  SparseModel first = ModelOf(rover_, 0, 6, Sim3()), second = ModelOf(rover_, 6, 12, Sim3());
  Shift(first, Left(0), 0.5);
  Shift(first, Left(5), 0.5);
  Shift(second, Left(6), -0.5);
  const auto aligned = Align({first, second}, rover_.world_from_left, rover_.rig, options_);
  for (int k : {1, 2, 3, 4, 7, 8, 9, 10, 11}) {
    EXPECT_LT(
        (aligned.world_from_left[k]->translation - rover_.world_from_left[k].translation).norm(),
        1e-9)  // m
        << k;
  }
}

TEST_F(BaselineScaleTest, AModelWithoutAStereoPairIsLeftOut) {
  SparseModel lone = ModelOf(rover_, 0, 4, Sim3());
  std::erase_if(lone.images, [](const SparseImage& image) { return image.ref.eye == Eye::kRight; });
  const auto aligned =
      Align({lone, ModelOf(rover_, 6, 12, Sim3())}, rover_.world_from_left, rover_.rig, options_);
  ASSERT_EQ(aligned.models.size(), 1u);
  EXPECT_EQ(aligned.models[0].model, 1);
  EXPECT_FALSE(aligned.world_from_left[0]);
  EXPECT_TRUE(aligned.world_from_left[6]);
}

TEST(ScaleOptions, DefaultsHoldAndNonsenseIsRefused) {
  RequireValid(ScaleOptions{});
  EXPECT_THROW(RequireValid(ScaleOptions{.max_sigmas = 0.0}), UsageError);
  EXPECT_THROW(RequireValid(ScaleOptions{.min_tolerated_share = -0.1}), UsageError);
}

}  // namespace
}  // namespace rigmap
