#include "export/tum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/seeded_random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

constexpr StampNs kFirstStampNs = 1448551416619000123;

Trajectory RandomTrajectory(SeededRandom& random, int count) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    TimedPose pose;
    pose.stamp_ns = kFirstStampNs + i * 400'000'001LL;
    pose.world_from_left = random.Motion(1000.0);
    trajectory.push_back(pose);
  }
  return trajectory;
}

// The message of the DataError that reading `text` throws; empty if it reads.
std::string ComplaintAbout(const std::string& text) {
  const TemporaryFolder folder;
  try {
    ReadTum(WriteTestFile(folder.Path() / "t.tum", text));
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

TEST(Tum, ReadsBackWhatItWrites) {
  SeededRandom random;
  const TemporaryFolder folder;
  const Trajectory trajectory = RandomTrajectory(random, 100);
  const auto poses = ReadTum(WriteTestFile(folder.Path() / "t.tum", WriteTum(trajectory)));
  ASSERT_EQ(poses.size(), trajectory.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Rigid3& written = trajectory[i].world_from_left;
    const Rigid3& read = poses[i].world_from_body;
    EXPECT_EQ(poses[i].stamp_ns, trajectory[i].stamp_ns);
    EXPECT_LT((read.translation - written.translation).cwiseAbs().maxCoeff(), 1e-9);  // m
    EXPECT_GE(read.rotation.w(), 0.0);
    EXPECT_LT(AngleOf(read.rotation.conjugate() * written.rotation), 4e-12);  // rad
  }
}

TEST(Tum, WritesEightFieldsPerLine) {
  Trajectory trajectory(1);
  trajectory[0].stamp_ns = 1448551416619000000;
  trajectory[0].world_from_left = {Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5), {1.0, -2.5, 0.125}};
  EXPECT_EQ(WriteTum(trajectory),
            "1448551416.619000000 1.000000000 -2.500000000 0.125000000 "
            "-0.500000000000 0.500000000000 -0.500000000000 0.500000000000\n");
  EXPECT_EQ(WriteTum({}), "");
}

TEST(Tum, PassesOverCommentsAndBlankLinesAndSortsByTime) {
  const TemporaryFolder folder;
  const auto path = WriteTestFile(folder.Path() / "t.tum",
                                  "# t tx ty tz qx qy qz qw\r\n\n"
                                  "2.5,4,5,6,0,0,0,1\r\n"
                                  "   \t\n"
                                  "  1.5\t1 2, 3 0 0 1e0 +0\n"
                                  " # end\n"
                                  "1.448551416619e+00 7 8 9 0 0 0.995 0");
  const auto poses = ReadTum(path);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[0].stamp_ns, 1448551417);
  EXPECT_EQ(poses[1].stamp_ns, 1'500'000'000);
  EXPECT_EQ(poses[2].stamp_ns, 2'500'000'000);
  EXPECT_EQ(poses[1].world_from_body.translation, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(poses[0].world_from_body.rotation.z(), 1.0);  // was 0.995: normalised
}

TEST(Tum, NamesFileAndLineOfWhatItCannotRead) {
  using testing::HasSubstr;
  EXPECT_THAT(ComplaintAbout("1 2 3\n"), HasSubstr("t.tum:1: expected 8 fields"));
  EXPECT_THAT(ComplaintAbout("1 0 0 0 0 0 0 1 5\n"), HasSubstr("found 9"));
  EXPECT_THAT(ComplaintAbout("#\n1 0 0 0 0 0 0 1\n2 0 zero 0 0 0 0 1\n"),
              HasSubstr("t.tum:3: expected a finite number, found 'zero'"));
  EXPECT_THAT(ComplaintAbout("1 0 nan 0 0 0 0 1\n"), HasSubstr("found 'nan'"));
  EXPECT_THAT(ComplaintAbout("now 0 0 0 0 0 0 1\n"), HasSubstr("t.tum:1: expected a time"));
  EXPECT_THAT(ComplaintAbout("1 0 0 0 0 0 0 0\n"), HasSubstr("expected a unit quaternion"));
  EXPECT_THAT(ComplaintAbout("1 0 0 0 0 0 0 1.02\n"), HasSubstr("length 1.02"));
  EXPECT_THAT(ComplaintAbout("# nothing\n"), HasSubstr("t.tum: expected a TUM trajectory"));
  EXPECT_THAT(ComplaintAbout(""), HasSubstr("found no pose"));
  EXPECT_THROW(ReadTum("no/such/file.tum"), DataError);
}

TEST(Tum, AnotherPointIsCarriedRigidly) {
  SeededRandom random;
  const TemporaryFolder folder;
  const Trajectory trajectory = RandomTrajectory(random, 20);
  const Rigid3 left_from_body = random.Motion(2.0);
  const auto moved =
      ReadTum(WriteTestFile(folder.Path() / "t.tum", WriteTum(trajectory, left_from_body)));
  ASSERT_EQ(moved.size(), trajectory.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Rigid3 found = trajectory[i].world_from_left.Inverse() * moved[i].world_from_body;
    EXPECT_EQ(moved[i].stamp_ns, trajectory[i].stamp_ns);
    EXPECT_LT((found.translation - left_from_body.translation).norm(), 1e-8);
    EXPECT_LT(AngleOf(found.rotation.conjugate() * left_from_body.rotation), 1e-8);
  }
}

}  // namespace
}  // namespace rigmap
