#include "simulation/drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "tests/support/synthetic_rover.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

constexpr StampNs kMillisecondNs = 1'000'000;

SimulationRequest Request(const std::string& path, int pairs = 40) {
  SimulationRequest request;
  request.path = path;
  request.pairs = pairs;
  request.rig = LocCamRig();
  return request;
}

std::vector<DriveFrame> FramesOnFlatGround(const DrivePlan& plan) {
  const RoverMotion motion(plan.path, [](double, double) { return 0.0; });
  return FramesOf(plan, motion, MountOf(LocCamRig()));
}

// Between the direction of a camera and that of the sun, on the plane.
double AnglePastSun(const DriveFrame& frame, const DrivePlan& plan) {
  const Eigen::Vector3d ahead = frame.world_from_left.rotation * Eigen::Vector3d::UnitZ();
  return std::abs(std::remainder(std::atan2(ahead.y(), ahead.x()) - plan.scene.sun_azimuth_rad,
                                 2.0 * std::numbers::pi));
}

TEST(Drive, StampsAreWholeMillisecondsAndIncrease) {
  for (const double interval_s : {0.4, 1.2}) {
    SimulationRequest request = Request("straight", 200);
    request.interval_s = interval_s;
    const auto frames = FramesOnFlatGround(PlanDrive(request));
    ASSERT_EQ(frames.size(), 200u);
    bool jitters = false;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].index, static_cast<int>(i));
      EXPECT_EQ(frames[i].stamp_ns % kMillisecondNs, 0);
      EXPECT_NEAR(frames[i].time_s, i * interval_s, 0.0401);
      EXPECT_EQ(frames[i].stamp_ns - frames[0].stamp_ns, std::llround(frames[i].time_s * 1e9));
      jitters = jitters || std::abs(frames[i].time_s - i * interval_s) > 0.01;
      if (i > 0) {
        EXPECT_GT(frames[i].stamp_ns, frames[i - 1].stamp_ns);
      }
    }
    EXPECT_TRUE(jitters);
  }
}

// The first and the last interval hold the start and the stop.
TEST(Drive, FramesKeepTheirSpacing) {
  for (const double spacing_m : {0.2, 0.63}) {
    SimulationRequest request = Request("straight", 60);
    request.spacing_m = spacing_m;
    const auto frames = FramesOnFlatGround(PlanDrive(request));
    for (std::size_t i = 2; i + 1 < frames.size(); ++i) {
      const double step_m =
          (frames[i].world_from_left.translation - frames[i - 1].world_from_left.translation)
              .norm();
      EXPECT_NEAR(step_m, spacing_m, 0.08 * spacing_m);
      EXPECT_NEAR(frames[i].travelled_m - frames[i - 1].travelled_m, step_m, 1e-6);
    }
    EXPECT_NEAR(frames.back().travelled_m, (59 - RoverPath::kRamp_s / 1.2) * spacing_m, 1e-6);
  }
}

TEST(Drive, CamerasRideAtTheirHeightAndLookDown) {
  for (const DriveFrame& frame : FramesOnFlatGround(PlanDrive(Request("loop")))) {
    EXPECT_NEAR(frame.world_from_left.translation.z(), 1.1, 0.01);
    const Eigen::Vector3d ahead = frame.world_from_left.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(-std::asin(ahead.z()), 17.95 * std::numbers::pi / 180.0, 0.002);
  }
}

TEST(Drive, UTurnEndsTowardsTheSunAndGlaresThere) {
  const DrivePlan plan = PlanDrive(Request("u-turn"));
  const auto frames = FramesOnFlatGround(plan);
  EXPECT_NEAR(AnglePastSun(frames.front(), plan), std::numbers::pi, 0.02);
  EXPECT_NEAR(AnglePastSun(frames.back(), plan), 0.0, 0.02);
  EXPECT_NEAR(frames.back().fault.glare_area, 0.25, 1e-9);
  int glaring = 0;
  for (const DriveFrame& frame : frames) {
    glaring += frame.fault.glare_area > 0.0;
    if (AnglePastSun(frame, plan) > 1.0) {
      EXPECT_EQ(frame.fault.glare_area, 0.0);
    }
  }
  EXPECT_GT(glaring, 8);
  EXPECT_LT(glaring, 25);
}

TEST(Drive, OtherPathsDoNotGlareByThemselves) {
  for (const char* path : {"straight", "loop", "s-curve", "spot-turn", "backwards"}) {
    for (const DriveFrame& frame : FramesOnFlatGround(PlanDrive(Request(path)))) {
      EXPECT_EQ(frame.fault, FrameFault()) << path;
    }
  }
}

TEST(Drive, AskedGlareStandsBesideTheSuns) {
  SimulationRequest request = Request("u-turn");
  request.faults = {"glare=0:3", "glare-area=0.4"};
  const auto frames = FramesOnFlatGround(PlanDrive(request));
  EXPECT_EQ(frames[1].fault.glare_area, 0.4);
  EXPECT_EQ(frames[5].fault.glare_area, 0.0);
  EXPECT_NEAR(frames.back().fault.glare_area, 0.25, 1e-9);
}

TEST(Drive, OwnShadowHasTheSunBehind) {
  for (const char* path : {"straight", "u-turn"}) {
    SimulationRequest request = Request(path);
    request.faults = {"shadow=1"};
    const DrivePlan plan = PlanDrive(request);
    EXPECT_NEAR(AnglePastSun(FramesOnFlatGround(plan).front(), plan), std::numbers::pi, 0.3);
    EXPECT_GT(plan.scene.SunDirection().z(), 0.1);
  }
}

TEST(Drive, RequestReachesTheScene) {
  SimulationRequest request = Request("straight");
  request.scene = "flat-sand";
  request.seed = 77;
  request.contrast = 0.5;
  request.markers = 9;
  request.sand_cell_m = 0.02;
  const SceneOptions scene = PlanDrive(request).scene, bare = MakeScene("flat-sand", 77);
  EXPECT_EQ(scene.contrast, 0.5 * bare.contrast);
  EXPECT_EQ(scene.markers, 9);
  EXPECT_EQ(scene.sand_cell_m, 0.02);
  EXPECT_EQ(scene.seed, 77u);
  EXPECT_EQ(scene.terrain.seed, 77u);
}

TEST(Drive, PartsFollowEachOtherInTime) {
  SimulationRequest request = Request("straight", 35);
  const DrivePlan first = PlanDrive(request);
  request.part = 2;
  const DrivePlan second = PlanDrive(request);
  const auto end_s =
      static_cast<double>(second.clock.start_stamp_ns - first.clock.start_stamp_ns) * 1e-9;
  EXPECT_GT(end_s, first.frame_times_s.back() + kSensorsAfter_s + kSensorsBefore_s);
  EXPECT_EQ(second.frame_times_s, first.frame_times_s);
}

TEST(Drive, SeedsChangeTheDrive) {
  SimulationRequest request = Request("straight");
  const DrivePlan a = PlanDrive(request), same = PlanDrive(request);
  request.seed = 2;
  const DrivePlan other = PlanDrive(request);
  EXPECT_EQ(a.frame_times_s, same.frame_times_s);
  EXPECT_NE(a.frame_times_s, other.frame_times_s);
  EXPECT_NE(a.path.At(0.0).heading_rad, other.path.At(0.0).heading_rad);
}

TEST(Drive, FaultsTakeImagesAway) {
  SimulationRequest request = Request("straight", 12);
  request.faults = {"dropped=2:3", "lone-left=3:4", "lone-right=4:5", "black=5:6", "truncated=6:7"};
  const auto frames = FramesOnFlatGround(PlanDrive(request));
  const auto has = [&](int i, bool left, bool right) {
    return frames[i].HasImage(Eye::kLeft) == left && frames[i].HasImage(Eye::kRight) == right &&
           frames[i].IsPaired() == (left && right);
  };
  EXPECT_TRUE(has(1, true, true) && has(2, false, false) && has(3, true, false) &&
              has(4, false, true) && has(5, true, true) && has(6, true, true));
  for (int i = 0; i < 12; ++i) EXPECT_EQ(frames[i].IsUsable(), i < 2 || i > 6) << i;
}

TEST(Drive, TimesOfARangeHoldItsFramesOnly) {
  const DrivePlan plan = PlanDrive(Request("straight"));
  const auto spans = TimesOf(plan, {{3, 7}, {20, 21}});
  ASSERT_EQ(spans.size(), 2u);
  for (int i = 0; i < 40; ++i) {
    const bool held = std::ranges::any_of(
        spans, [&](const TimeSpan& span) { return span.Contains(plan.frame_times_s[i]); });
    EXPECT_EQ(held, (i >= 3 && i < 7) || i == 20) << i;
  }
}

TEST(Drive, ComplainsInSentences) {
  const auto complaint = [](auto change) -> std::string {
    SimulationRequest request = Request("straight");
    change(request);
    try {
      PlanDrive(request);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(complaint([](auto&) {}), "none");
  EXPECT_THAT(complaint([](auto& r) { r.pairs = 2; }), HasSubstr("expected 3 to 20000, found 2"));
  EXPECT_THAT(complaint([](auto& r) { r.spacing_m = 0.0; }), HasSubstr("spacing"));
  EXPECT_THAT(complaint([](auto& r) { r.spacing_m = NAN; }), HasSubstr("spacing"));
  EXPECT_THAT(complaint([](auto& r) { r.interval_s = 0.01; }), HasSubstr("interval"));
  EXPECT_THAT(complaint([](auto& r) { r.contrast = -1.0; }), HasSubstr("contrast"));
  EXPECT_THAT(complaint([](auto& r) { r.clock_offset_s = NAN; }), HasSubstr("clock offset"));
  EXPECT_THAT(complaint([](auto& r) { r.traverse = 4; }), HasSubstr("1, 2 or 3"));
  EXPECT_THAT(complaint([](auto& r) { r.part = 0; }), HasSubstr("part"));
  EXPECT_THAT(complaint([](auto& r) { r.depth_every = 0; }), HasSubstr("depth-every"));
  EXPECT_THAT(complaint([](auto& r) { r.markers = -1; }), HasSubstr("markers"));
  EXPECT_THAT(complaint([](auto& r) { r.sand_cell_m = 1.0; }), HasSubstr("sand cell"));
  EXPECT_THAT(complaint([](auto& r) { r.scene = "moon"; }), HasSubstr("found 'moon'"));
  EXPECT_THAT(complaint([](auto& r) { r.path = "spiral"; }), HasSubstr("spiral"));
  EXPECT_THAT(complaint([](auto& r) { r.faults = {"fog=1"}; }), HasSubstr("fog"));
}

}  // namespace
}  // namespace rigmap
