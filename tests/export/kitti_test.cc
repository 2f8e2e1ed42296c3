#include "export/kitti.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

TEST(Kitti, ReadsBackInTheSameOrder) {
  SeededRandom random;
  Trajectory trajectory(50);
  for (TimedPose& pose : trajectory) pose.world_from_left = random.Motion(1000.0);
  std::istringstream text(WriteKitti(trajectory));
  std::string line;
  for (const TimedPose& pose : trajectory) {
    ASSERT_TRUE(std::getline(text, line));
    std::istringstream numbers(line);
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> read;
    for (double& number : read.reshaped<Eigen::RowMajor>()) ASSERT_TRUE(numbers >> number) << line;
    EXPECT_TRUE(numbers.eof()) << line;  // evo takes no blank at the end
    const Rigid3& written = pose.world_from_left;
    EXPECT_LT((read.col(3) - written.translation).cwiseAbs().maxCoeff(), 1e-9);  // m
    EXPECT_LT((read.leftCols<3>() - written.rotation.toRotationMatrix()).cwiseAbs().maxCoeff(),
              1e-12);
  }
  EXPECT_FALSE(std::getline(text, line));
}

TEST(Kitti, WritesTwelveNumbersPerLine) {
  Trajectory trajectory(1);
  trajectory[0].world_from_left = {Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1.0, -2.5, 0.125}};
  EXPECT_EQ(WriteKitti(trajectory),
            "0.000000000000 0.000000000000 1.000000000000 1.000000000 "
            "1.000000000000 0.000000000000 0.000000000000 -2.500000000 "
            "0.000000000000 1.000000000000 0.000000000000 0.125000000\n");
  EXPECT_EQ(WriteKitti({}), "");
}

}  // namespace
}  // namespace rigmap
