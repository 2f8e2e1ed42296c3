#include "adjustment/carry_groups.h"

#include <gtest/gtest.h>

namespace rigmap {
namespace {

Rigid3 At(double x_m, double turned_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ())),
          {x_m, 0.0, 0.0}};
}

double Apart(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm() + AngleOf(a.rotation.conjugate() * b.rotation);
}

// Six frames a metre apart. The adjustment has bent and stretched the first three and left the
// datum of the last three, whose own steps it has lengthened, where it was; frame 3 was not posed.
class CarryGroups : public testing::Test {
 protected:
  CarryGroups() {
    for (int i = 0; i < 7; ++i) start_.push_back(At(i, 0.0));
    adjusted_.world_from_left = {At(0.0, 0.0), At(1.2, 0.1), At(2.4, 0.2), std::nullopt,
                                 At(4.0, 0.0), At(5.1, 0.0), At(6.2, 0.0)};
    adjusted_.datum_frames = {0, 0, 0, 3, 4, 4, 4};
    adjusted_.covariances.assign(7, Matrix6d::Zero());
    adjusted_.covariances[5](0, 0) = 1.0;
    adjusted_.by_calibration.assign(7, PoseCalibration::Zero());
    adjusted_.by_calibration[5](0, kLogFocal) = 1.0;
    adjusted_.points = {{{5.0, 2.0, 0.0}, {{1, 0, Eye::kLeft, {}}, {2, 0, Eye::kLeft, {}}}},
                        {{6.0, 2.0, 0.0}, {{5, 0, Eye::kLeft, {}}, {6, 0, Eye::kLeft, {}}}}};
  }
  Rigid3 Step(int from, int to) const {
    return adjusted_.world_from_left[from]->Inverse() * *adjusted_.world_from_left[to];
  }

  std::vector<std::optional<Rigid3>> start_;
  Adjustment adjusted_;
};

TEST_F(CarryGroups, LieToEachOtherAsTheyDid) {
  const Adjustment before = adjusted_;
  CarryGroupsAlong(start_, adjusted_);
  EXPECT_LT(Apart(Step(2, 4), start_[2]->Inverse() * *start_[4]), 1e-12);
  // Nothing else has changed: the first group, and the second within itself.
  for (const int i : {0, 1, 2}) {
    EXPECT_LT(Apart(*adjusted_.world_from_left[i], *before.world_from_left[i]), 1e-12);
  }
  EXPECT_FALSE(adjusted_.world_from_left[3]);
  EXPECT_LT(Apart(Step(4, 6), before.world_from_left[4]->Inverse() * *before.world_from_left[6]),
            1e-12);
  EXPECT_EQ(adjusted_.points[0].x, before.points[0].x);
  EXPECT_LT((adjusted_.world_from_left[5]->Inverse() * adjusted_.points[1].x -
             before.world_from_left[5]->Inverse() * before.points[1].x)
                .norm(),
            1e-12);
  // The group has turned by 0.2 about z, and its errors with it.
  EXPECT_NEAR(adjusted_.covariances[5](1, 1), std::pow(std::sin(0.2), 2), 1e-12);
  EXPECT_NEAR(adjusted_.by_calibration[5](1, kLogFocal), std::sin(0.2), 1e-12);
}

TEST_F(CarryGroups, OneGroupStays) {
  adjusted_.datum_frames = {0, 0, 0, 3, 0, 0, 0};
  const Adjustment before = adjusted_;
  CarryGroupsAlong(start_, adjusted_);
  for (const int i : {0, 1, 2, 4, 5, 6}) {
    EXPECT_LT(Apart(*adjusted_.world_from_left[i], *before.world_from_left[i]), 1e-15);
  }
}

}  // namespace
}  // namespace rigmap
