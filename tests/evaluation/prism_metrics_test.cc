#include "evaluation/prism_metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/evaluation/reference_scorer.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::HasSubstr;

using Poses = std::vector<TumPose>;
using Track = std::vector<PrismPosition>;

constexpr StampNs kIntervalNs = 1'000'000'000;
const Eigen::Vector3d kPrismInBody(0.16, -0.3, -0.25);

// A winding drive of about 6 m that turns by a half and slows down, so that lever arm and clock are
// both told.
Poses Drive(int count = 60) {
  Poses poses;
  Rigid3 world_from_body;
  for (int i = 0; i < count; ++i) {
    poses.push_back({i * kIntervalNs, world_from_body});
    const double turn_rad = 0.12 * std::sin(0.15 * i) + 0.03;
    world_from_body =
        world_from_body * Rigid3{ExpRotation({0.02 * std::sin(0.4 * i), 0.01, turn_rad}),
                                 Eigen::Vector3d(0.1 + 0.06 * std::cos(0.3 * i), 0.0, 0.0)};
  }
  return poses;
}

// Where the prism is seen, in a plane of its own, by a clock that is ahead.
Track TrackOf(const Poses& poses, double clock_offset_s) {
  Track track;
  for (const TumPose& pose : poses) {
    const Eigen::Vector3d prism = pose.world_from_body * kPrismInBody;
    track.push_back(
        {pose.stamp_ns + static_cast<StampNs>(1e9 * clock_offset_s),
         Eigen::Rotation2Dd(2.1) * Eigen::Vector2d(prism.head<2>()) + Eigen::Vector2d(3.8, -7.0)});
  }
  return track;
}

TEST(ComparePrism, FindsWhatTheTrackWasMadeWith) {
  const Poses poses = Drive();
  const PrismMetrics metrics = ComparePrism(poses, TrackOf(poses, 0.4));
  ASSERT_TRUE(metrics.rigid && metrics.similar);
  EXPECT_EQ(metrics.frames, 60U);
  EXPECT_GE(metrics.rigid->inside, 59U);
  EXPECT_LT(metrics.rigid->rms_m, 1e-3);  // what the priors on lever arm and clock ask for
  EXPECT_LT((metrics.rigid->prism_in_body - kPrismInBody).head<2>().norm(), 0.02);
  EXPECT_NEAR(metrics.rigid->clock_offset_s, 0.4, 0.02);
  EXPECT_EQ(metrics.rigid->scale, 1.0);
  EXPECT_NEAR(metrics.similar->scale, 1.0, 2e-3);
}

TEST(ComparePrism, ShowsAWrongScale) {
  Poses poses = Drive();
  const Track track = TrackOf(poses, 0.0);
  for (TumPose& pose : poses) pose.world_from_body.translation /= 1.05;
  const PrismMetrics metrics = ComparePrism(poses, track);
  ASSERT_TRUE(metrics.rigid && metrics.similar);
  EXPECT_NEAR(metrics.similar->scale, 1.05, 0.005);
  EXPECT_LT(metrics.similar->rms_m, 0.003);
  EXPECT_GT(metrics.rigid->rms_m, 0.01);
}

// Of a drive of less than a second a clock that is off by one leaves no pose in the track's time.
TEST(ComparePrism, DoesNotLeaveTheTrackToFitIt) {
  Poses poses = Drive(40);
  for (TumPose& pose : poses) pose.stamp_ns /= 50;
  const Track track = TrackOf(poses, 0.0);
  for (TumPose& pose : poses) pose.world_from_body.translation /= 1.3;
  const PrismMetrics metrics = ComparePrism(poses, track);
  ASSERT_TRUE(metrics.rigid && metrics.similar);
  EXPECT_GE(metrics.rigid->inside, 30U);
  EXPECT_GE(metrics.similar->inside, 30U);
  EXPECT_NEAR(metrics.similar->scale, 1.3, 0.03);
  EXPECT_GT(metrics.rigid->rms_m, 0.05);
}

TEST(ComparePrism, DoesNotDependOnTheHeadingOfTheWorld) {
  SeededRandom random;
  Poses poses = Drive();
  const Track track = TrackOf(poses, 0.0);
  for (TumPose& pose : poses) pose.world_from_body.translation += random.Noise(0.01);
  const PrismMetrics before = ComparePrism(poses, track);
  const Rigid3 turn{ExpRotation({0.0, 0.0, 1.0}), Eigen::Vector3d(5.0, 2.0, 1.0)};
  for (TumPose& pose : poses) pose.world_from_body = turn * pose.world_from_body;
  const PrismMetrics after = ComparePrism(poses, track);
  EXPECT_GT(before.rigid->rms_m, 0.005);
  EXPECT_NEAR(after.rigid->rms_m, before.rigid->rms_m, 1e-5);
  EXPECT_NEAR(after.similar->scale, before.similar->scale, 1e-4);
}

TEST(ComparePrism, HasNoFigureWithoutATrackOfThatTime) {
  const Poses poses = Drive();
  const Track later = TrackOf(poses, 1000.0);
  EXPECT_FALSE(ComparePrism(poses, later).rigid);
  EXPECT_THAT(ToJson(ComparePrism(poses, later))["error"].get<std::string>(),
              HasSubstr("time of the prism's track"));
  EXPECT_FALSE(ComparePrism({}, later).rigid);
}

class PrismFileTest : public testing::Test {
 protected:
  fs::path File(const std::string& text) const {
    return WriteTestFile(folder_.Path() / "prism.txt", text);
  }
  std::string ErrorOf(const std::string& text) const {
    try {
      ReadPrismFile(File(text));
    } catch (const DataError& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

TEST_F(PrismFileTest, IsReadAndToldFromPoses) {
  const fs::path path = File("# t x y\n1.5 2 -3e-1\n\n2.5 2.25 0.5  # a note\n");
  EXPECT_TRUE(IsPrismFile(path));
  const Track track = ReadPrismFile(path);
  ASSERT_EQ(track.size(), 2U);
  EXPECT_EQ(track[0].stamp_ns, 1'500'000'000);
  EXPECT_EQ(track[0].position, Eigen::Vector2d(2.0, -0.3));
  EXPECT_FALSE(IsPrismFile(File("1 0 0 0 0 0 0 1\n")));
}

TEST_F(PrismFileTest, IsRefusedWithItsLine) {
  EXPECT_THAT(ErrorOf("1 2 3\n2 3\n"),
              HasSubstr("prism.txt:2: expected 3 fields 't x y', found 2"));
  EXPECT_THAT(ErrorOf("1 2 3\n2 nan 3\n"),
              HasSubstr("prism.txt:2: expected a finite number, found 'nan'"));
  EXPECT_THAT(ErrorOf("2 2 3\n1 2 3\n"), HasSubstr("prism.txt:2: expected times that increase"));
  EXPECT_THAT(ErrorOf("# nothing\n"), HasSubstr("expected positions of a prism"));
}

// The scorer that was written apart from rigmap; where lever arm and clock are hardly told the two
// searches end a little apart.
class PrismScorer : public ReferenceScorerTest {
 protected:
  void Compare(const fs::path& estimate, const fs::path& track) {
    const fs::path scorer = Scorer("prism_metrics.py");
    if (!fs::exists(scorer)) GTEST_SKIP() << scorer << " does not exist";
    const auto expected = ordered_json::parse(OutputOf(fmt::format(
        "{} '{}' '{}' '{}'", kPython, scorer.string(), estimate.string(), track.string())));
    const auto found = ToJson(ComparePrism(ReadTum(estimate), ReadPrismFile(track)));
    ASSERT_EQ(found.size(), expected.size()) << found << "\n" << expected;
    auto it = found.begin();
    for (const auto& [key, value] : expected.items()) {
      ASSERT_EQ(it.key(), key);
      const bool scale = key == "scale_truth_over_est";
      const double tolerance = scale ? 2e-5 : key.starts_with("rms") ? 1.01e-4 : 2.01e-3;
      for (std::size_t i = 0; i < (value.is_array() ? 3 : 1); ++i) {
        const double difference = value.is_array() ? value[i].get<double>() - (*it)[i].get<double>()
                                                   : value.get<double>() - it->get<double>();
        EXPECT_LE(std::abs(difference), tolerance) << key << "\n" << found << "\n" << expected;
      }
      ++it;
    }
  }
  fs::path Write(const Poses& poses) const {
    Trajectory trajectory;
    for (const TumPose& pose : poses) {
      TimedPose timed;
      timed.stamp_ns = pose.stamp_ns;
      timed.world_from_left = pose.world_from_body;
      trajectory.push_back(timed);
    }
    return WriteTestFile(folder_.Path() / "estimate.tum", WriteTum(trajectory));
  }

  TemporaryFolder folder_;
  SeededRandom random_;
};

TEST_F(PrismScorer, AgreesOnADrive) {
  Poses poses = Drive();
  std::string text = "# t x y\n";
  for (const PrismPosition& position : TrackOf(poses, 0.3)) {
    text += fmt::format("{} {} {}\n", FormatSeconds(position.stamp_ns), position.position.x(),
                        position.position.y());
  }
  for (TumPose& pose : poses) {
    pose.world_from_body.translation =
        pose.world_from_body.translation * 1.01 + random_.Noise(0.01);
  }
  Compare(Write(poses), WriteTestFile(folder_.Path() / "track.txt", text));
}

// Poses along the real track of a rover in a sand yard, on a line that does not tell the lever arm;
// in the midst of its time, since what a pose at its end costs depends on whether it lies inside.
TEST_F(PrismScorer, AgreesOnARealTrack) {
  const fs::path track = data_ / "sand-line/groundtruth_xy.txt";
  if (!fs::exists(track)) GTEST_SKIP() << track << " does not exist";
  Poses poses;
  Track whole = ReadPrismFile(track);
  for (const PrismPosition& position : std::span(whole).subspan(3, whole.size() - 6)) {
    const Eigen::Vector3d at(1.003 * position.position.x(), 1.003 * position.position.y(), 0.0);
    poses.push_back({position.stamp_ns, {random_.Rotation(0.02), at + random_.Noise(0.004)}});
  }
  Compare(Write(poses), track);
}

}  // namespace
}  // namespace rigmap
