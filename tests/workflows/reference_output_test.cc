// The references that a report draws, on a drive along a curve.
#include "workflows/stages/reference_output.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "georeference/local_frame.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

const Geodetic kBeach{52.2141, 4.4004, 6.0};
const Eigen::Vector3d kLever(0.3, -0.2, -0.9);  // of antenna and prism, in the left eye

class ReferenceOutput : public testing::Test {
 protected:
  ReferenceOutput() {
    rig_.antenna_in_left = kLever;
    Rigid3 world_from_left;
    for (int i = 0; i < 60; ++i) {
      trajectory_.push_back({.stamp_ns = i * kSecondNs,
                             .world_from_left = world_from_left,
                             .source = PoseSource::kOdometry});
      world_from_left =
          world_from_left * Rigid3{ExpRotation({0.02 * std::sin(0.4 * i), 0.01, 0.06}),
                                   Eigen::Vector3d(0.15 + 0.05 * std::cos(0.3 * i), 0.0, 0.02)};
    }
  }
  nlohmann::ordered_json Describe() const {
    return DescribeReference({trajectory_, rig_, truth_, {}}, nlohmann::ordered_json::object(), {},
                             {});
  }
  // The largest distance of a reference from the pose of its time, over `axes` of them.
  double WorstDistance(const nlohmann::ordered_json& rows, int axes) const {
    double worst_m = 0.0;
    for (const auto& row : rows) {
      const auto i = static_cast<std::size_t>(
          std::lround(row[0].get<double>() / static_cast<double>(kSecondNs)));
      const Eigen::Vector3d x(row[1], row[2], row[3]);
      worst_m =
          std::max(worst_m, (x - trajectory_.at(i).world_from_left.translation).head(axes).norm());
    }
    return worst_m;
  }

  static constexpr StampNs kSecondNs = 1'000'000'000;
  TemporaryFolder folder_;
  StereoRig rig_;
  Trajectory trajectory_;
  Truth truth_;
};

TEST_F(ReferenceOutput, LaysThePrismsTrackOnThePathFromAbove) {
  std::string track;
  for (const TimedPose& pose : trajectory_) {
    const Eigen::Vector3d prism = pose.world_from_left * kLever;
    const Eigen::Vector2d seen =
        Eigen::Rotation2Dd(2.1) * Eigen::Vector2d(prism.head<2>()) + Eigen::Vector2d(3.8, -7.0);
    track += std::to_string(static_cast<double>(pose.stamp_ns) * 1e-9) + " " +
             std::to_string(seen.x()) + " " + std::to_string(seen.y()) + "\n";
  }
  truth_.path = WriteTestFile(folder_.Path() / "prism.txt", track).string();
  const auto reference = Describe();
  EXPECT_FALSE(reference.contains("truth"));
  EXPECT_GE(reference["prism"].size(), 58U);
  EXPECT_LT(WorstDistance(reference["prism"], 2), 0.005);
}

TEST_F(ReferenceOutput, LaysFixesOnThePathWithTheirOwnHeights) {
  const LocalFrame beach(kBeach);
  for (const TimedPose& pose : trajectory_) {
    const Eigen::Vector3d antenna = pose.world_from_left * kLever;
    Eigen::Vector3d enu = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * antenna;
    if (pose.stamp_ns == 20 * kSecondNs) enu.z() += 0.5;  // one height is off
    const Geodetic at = beach.ToGeodetic(enu);
    truth_.fixes.push_back({pose.stamp_ns, std::string(kRtkFixed), at.latitude_deg,
                            at.longitude_deg, at.altitude_m, Eigen::Vector3d(0.004, 0.004, 0.009)});
  }
  auto rows = Describe()["rtk"];
  ASSERT_GE(rows.size(), 58U);  // the clock's offset may put the first or last outside of the drive
  const auto raised = std::ranges::find_if(rows, [](const auto& row) {
    return std::lround(row[0].template get<double>() * 1e-9) == 20;
  });
  ASSERT_NE(raised, rows.end());
  EXPECT_NEAR((*raised)[3].get<double>() - trajectory_[20].world_from_left.translation.z(), 0.5,
              0.005);
  rows.erase(raised);
  EXPECT_LT(WorstDistance(rows, 3), 0.005);
}

}  // namespace
}  // namespace rigmap
