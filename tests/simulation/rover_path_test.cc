#include "simulation/rover_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector2d Direction(double heading_rad) {
  return {std::cos(heading_rad), std::sin(heading_rad)};
}

// The state at which the rover has travelled so far, to a micrometre.
PlanarState AfterMetres(const RoverPath& path, double travelled_m) {
  double low_s = 0.0, high_s = path.duration_s();
  for (int i = 0; i < 60; ++i) {
    const double middle_s = 0.5 * (low_s + high_s);
    (path.At(middle_s).travelled_m < travelled_m ? low_s : high_s) = middle_s;
  }
  return path.At(high_s);
}

class EveryPath : public testing::TestWithParam<std::string> {
 protected:
  std::vector<PathRequest> Requests() const {
    std::vector<PathRequest> requests;
    for (const int intervals : {4, 15, 40, 120}) {
      requests.push_back({GetParam(), intervals, 0.2, 1.25, 0.7});
      requests.push_back({GetParam(), intervals, 0.5, 1.0, -2.0});
    }
    return requests;
  }
};

TEST_P(EveryPath, TakesItsTimeAndIsNoLongerThanAsked) {
  for (const PathRequest& request : Requests()) {
    const RoverPath path = MakeRoverPath(request);
    EXPECT_NEAR(path.duration_s(), request.intervals * request.interval_s, 1e-9);
    EXPECT_LE(path.length_m(), request.intervals * request.spacing_m);
    EXPECT_NEAR(path.At(path.duration_s()).travelled_m, path.length_m(), 1e-9);
  }
}

TEST_P(EveryPath, RestsBeforeAndAfter) {
  for (const PathRequest& request : Requests()) {
    const RoverPath path = MakeRoverPath(request);
    for (const double time_s : {-100.0, -2.0, 0.0}) {
      const PlanarState state = path.At(time_s);
      EXPECT_EQ(state.position_m, Eigen::Vector2d::Zero());
      EXPECT_NEAR(state.heading_rad, request.start_heading_rad, 1e-12);
      EXPECT_NEAR(state.speed_mps, 0.0, 1e-9);
      EXPECT_NEAR(state.yaw_rate_radps, 0.0, 1e-9);
    }
    const PlanarState end = path.At(path.duration_s()), later = path.At(path.duration_s() + 50.0);
    EXPECT_EQ(end.position_m, later.position_m);
    EXPECT_NEAR(later.speed_mps, 0.0, 1e-9);
  }
}

TEST_P(EveryPath, StatesAreEachOthersDerivatives) {
  constexpr double kStep_s = 1e-4;
  SeededRandom random;
  for (const PathRequest& request : Requests()) {
    const RoverPath path = MakeRoverPath(request);
    for (int i = 0; i < 200; ++i) {
      const double time_s = random.Uniform(-0.5, path.duration_s() + 0.5);
      const PlanarState state = path.At(time_s);
      const PlanarState before = path.At(time_s - kStep_s), after = path.At(time_s + kStep_s);
      const Eigen::Vector2d velocity = (after.position_m - before.position_m) / (2.0 * kStep_s);
      const Eigen::Vector2d expected = state.speed_mps * Direction(state.heading_rad);
      EXPECT_LT((velocity - expected).norm(), 1e-3) << time_s;  // m/s
      EXPECT_NEAR((after.heading_rad - before.heading_rad) / (2.0 * kStep_s), state.yaw_rate_radps,
                  1e-3);
      EXPECT_NEAR((after.travelled_m - before.travelled_m) / (2.0 * kStep_s),
                  std::abs(state.speed_mps), 1e-3);
    }
  }
}

TEST_P(EveryPath, HasNoTightCurveAndNoSuddenChange) {
  for (const PathRequest& request : Requests()) {
    const RoverPath path = MakeRoverPath(request);
    const double full_mps = request.spacing_m / request.interval_s;
    PlanarState last = path.At(0.0);
    for (double time_s = 0.01; time_s < path.duration_s(); time_s += 0.01) {
      const PlanarState state = path.At(time_s);
      const bool on_the_spot = std::abs(state.speed_mps) < 1e-9;
      if (!on_the_spot) {
        EXPECT_LE(std::abs(state.yaw_rate_radps) * kSmallestRadius_m,
                  std::abs(state.speed_mps) + 1e-9);
      }
      EXPECT_LE(std::abs(state.speed_mps - last.speed_mps),
                0.01 * full_mps / RoverPath::kRamp_s + 1e-9);
      EXPECT_LE(std::abs(state.yaw_rate_radps - last.yaw_rate_radps),
                0.01 * 2.0 * full_mps / kSmallestRadius_m / RoverPath::kRamp_s + 1e-9);
      last = state;
    }
  }
}

TEST_P(EveryPath, TurnsWithItsStartHeading) {
  PathRequest request{GetParam(), 40, 0.2, 1.25, 0.0};
  const RoverPath path = MakeRoverPath(request);
  request.start_heading_rad = 1.1;
  const RoverPath turned = MakeRoverPath(request);
  const Eigen::Rotation2Dd rotation(1.1);
  for (double time_s = 0.0; time_s < path.duration_s(); time_s += 0.7) {
    EXPECT_LT((rotation * path.At(time_s).position_m - turned.At(time_s).position_m).norm(), 1e-9);
  }
}

TEST_P(EveryPath, OutlineFollowsItInSteps) {
  const RoverPath path = MakeRoverPath({GetParam(), 40, 0.2, 1.25, 0.3});
  const auto outline = path.Outline(0.1);
  EXPECT_EQ(outline.front(), Eigen::Vector2d::Zero());
  EXPECT_LT((outline.back() - path.At(path.duration_s()).position_m).norm(), 1e-6);
  double sum_m = 0.0;
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const double step_m = (outline[i] - outline[i - 1]).norm();
    EXPECT_LE(step_m, 0.1 + 1e-9);
    sum_m += step_m;
  }
  EXPECT_NEAR(sum_m, path.length_m(), 0.01 * path.length_m());
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryPath, testing::ValuesIn(kPathNames), [](const auto& shape) {
  std::string name = shape.param;
  std::erase(name, '-');
  return name;
});

TEST(RoverPath, SegmentsAreExactArcs) {
  SeededRandom random;
  for (int i = 0; i < 50; ++i) {
    const double length_m = random.Uniform(2.0, 20.0), turn_rad = random.Uniform(-2.0, 2.0);
    const double heading_rad = random.Uniform(-kPi, kPi);
    const PathSegment arc{length_m, turn_rad, length_m / 0.2};
    const PlanarState end = RoverPath(std::span(&arc, 1), heading_rad).At(1e3);
    const double chord_m = 2.0 * length_m / turn_rad * std::sin(0.5 * turn_rad);
    EXPECT_LT((end.position_m - chord_m * Direction(heading_rad + 0.5 * turn_rad)).norm(), 1e-8);
    EXPECT_NEAR(end.heading_rad, heading_rad + turn_rad, 1e-12);
  }
}

TEST(RoverPath, LoopComesPastItsStartInTheSameDirection) {
  const RoverPath path = MakeRoverPath({"loop", 40, 0.2, 1.25, 0.4});
  const double round_m = path.length_m() / 1.25;
  EXPECT_NEAR(round_m / (2.0 * kPi), 1.0, 0.02);
  for (double travelled_m = 0.05; travelled_m < 0.25 * round_m - 0.05; travelled_m += 0.2) {
    const PlanarState first = AfterMetres(path, travelled_m);
    const PlanarState again = AfterMetres(path, travelled_m + round_m);
    EXPECT_LT((first.position_m - again.position_m).norm(), 1e-3);  // m
    EXPECT_NEAR(again.heading_rad - first.heading_rad, 2.0 * kPi, 1e-3);
  }
}

TEST(RoverPath, OppositeLoopComesBackAlongItsStem) {
  for (const int intervals : {40, 100}) {
    const RoverPath path = MakeRoverPath({"loop-opposite", intervals, 0.2, 1.25, -1.0});
    const PlanarState end = path.At(path.duration_s());
    EXPECT_LT(end.position_m.norm(), 0.01);  // m
    EXPECT_NEAR(end.heading_rad, -1.0 + kPi, 1e-9);
    for (double travelled_m = 0.1; travelled_m < 0.9; travelled_m += 0.2) {
      const PlanarState out = AfterMetres(path, travelled_m);
      const PlanarState back = AfterMetres(path, path.length_m() - travelled_m);
      EXPECT_LT((out.position_m - back.position_m).norm(), 0.01);  // m
    }
  }
}

TEST(RoverPath, UTurnComesBackOnAParallelLane) {
  const RoverPath path = MakeRoverPath({"u-turn", 60, 0.2, 1.25, 0.0});
  const PlanarState halfway = AfterMetres(path, 0.49 * path.length_m());
  EXPECT_NEAR(halfway.position_m.y(), 0.0, 1e-9);
  const PlanarState end = path.At(path.duration_s());
  EXPECT_NEAR(end.heading_rad, kPi, 1e-9);
  EXPECT_NEAR(end.position_m.y(), 2.0 * path.length_m() / 10.0, 0.01);
  EXPECT_LT(end.position_m.x(), 0.8 * halfway.position_m.x());
}

TEST(RoverPath, StopAndGoStandsForSeveralFrames) {
  for (const auto& [intervals, expected_stops] : {std::pair{40, 2}, std::pair{60, 3}}) {
    const RoverPath path = MakeRoverPath({"stop-and-go", intervals, 0.2, 1.25, 0.0});
    int stops = 0, still_frames = 0;
    for (int frame = 1; frame < intervals; ++frame) {
      const bool still = path.At((frame + 0.5) * 1.25).speed_mps < 1e-9;
      stops += still && still_frames == 0 ? 1 : 0;
      if (!still && still_frames > 0) {
        EXPECT_GE(still_frames, 4);
      }
      still_frames = still ? still_frames + 1 : 0;
    }
    EXPECT_EQ(stops, expected_stops);
  }
}

TEST(RoverPath, SpotTurnStaysInOnePosition) {
  const RoverPath path = MakeRoverPath({"spot-turn", 40, 0.2, 1.25, 0.0});
  EXPECT_NEAR(path.At(path.duration_s()).heading_rad, 0.5 * kPi, 1e-9);
  const PlanarState middle = path.At(0.5 * path.duration_s());
  EXPECT_NEAR(middle.yaw_rate_radps * 1.25, 6.0 * kPi / 180.0, 1e-9);
  const Eigen::Vector2d end = path.At(path.duration_s()).position_m;
  EXPECT_NEAR(end.x(), 0.5 * path.length_m(), 1e-6);
  EXPECT_NEAR(end.y(), 0.5 * path.length_m(), 1e-6);
}

TEST(RoverPath, BackwardsLooksAwayFromWhereItGoes) {
  const RoverPath path = MakeRoverPath({"backwards", 40, 0.2, 1.25, 0.0});
  const PlanarState end = path.At(path.duration_s());
  EXPECT_LT(end.position_m.x(), -7.0);
  EXPECT_LT(path.At(10.0).speed_mps, 0.0);
  EXPECT_GT(end.travelled_m, 7.0);
}

TEST(RoverPath, Traverse3IsCutFromOneOutline) {
  const RoverPath whole = MakeRoverPath({"traverse3", 1105, 0.2, 1.25, 0.0});
  EXPECT_NEAR(whole.length_m(), kTraverse3_m, 0.1);
  const RoverPath start = MakeRoverPath({"traverse3", 100, 0.2, 1.25, 0.0});
  for (double travelled_m = 0.1; travelled_m < start.length_m() - 0.1; travelled_m += 0.5) {
    EXPECT_LT(
        (AfterMetres(whole, travelled_m).position_m - AfterMetres(start, travelled_m).position_m)
            .norm(),
        1e-3);  // m
  }
  for (double time_s = 0.5; time_s < 50.0; time_s += 1.0) {
    EXPECT_LT(std::abs(start.At(time_s).yaw_rate_radps), start.At(time_s).speed_mps / 10.0);
  }
  EXPECT_THROW(MakeRoverPath({"traverse3", 1200, 0.2, 1.25, 0.0}), UsageError);
}

TEST(RoverPath, RefusesWhatItCannotDrive) {
  try {
    MakeRoverPath({"zigzag", 40, 0.2, 1.25, 0.0});
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("zigzag"));
    for (const std::string& name : kPathNames) {
      EXPECT_THAT(error.what(), testing::HasSubstr(name));
    }
  }
  EXPECT_THROW(MakeRoverPath({"straight", 0, 0.2, 1.25, 0.0}), UsageError);
  EXPECT_THROW(MakeRoverPath({"straight", 40, 0.0, 1.25, 0.0}), UsageError);
  EXPECT_THROW(MakeRoverPath({"straight", 40, 0.2, -1.0, 0.0}), UsageError);
  EXPECT_THROW(MakeRoverPath({"straight", 40, std::nan(""), 1.25, 0.0}), UsageError);
  EXPECT_THROW(MakeRoverPath({"straight", 1, 0.2, 1.25, 0.0}), UsageError);
}

}  // namespace
}  // namespace rigmap
