#include "adjustment/internal/pose_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

// Blocks of a band and, as a loop closure leaves them, of the first pose with the last ones.
class PoseMatrixTest : public testing::Test {
 protected:
  static constexpr int kUnknowns = 12, kBand = 3;

  PoseMatrixTest() : dense_(Eigen::MatrixXd::Zero(6 * kUnknowns, 6 * kUnknowns)) {
    for (int column = 0; column < kUnknowns; ++column) {
      for (int row = column; row < kUnknowns; ++row) {
        const bool is_loop = column == 0 && row >= kUnknowns - 2;
        if (row - column > kBand && !is_loop) continue;
        pairs_.emplace_back(column, row);
        blocks_.push_back(RandomBlock());
        if (row == column) {
          blocks_.back() =
              blocks_.back() * blocks_.back().transpose() + 50.0 * Matrix6d::Identity();
        }
        dense_.block<6, 6>(6 * row, 6 * column) = blocks_.back();
        dense_.block<6, 6>(6 * column, 6 * row) = blocks_.back().transpose();
      }
    }
  }

  Matrix6d RandomBlock() {
    return Matrix6d::NullaryExpr([&](auto, auto) { return random_.Uniform(-1.0, 1.0); });
  }

  SeededRandom random_;
  std::vector<PoseMatrix::Pair> pairs_;
  std::vector<Matrix6d> blocks_;
  Eigen::MatrixXd dense_;
};

TEST_F(PoseMatrixTest, SolvesAsTheDenseMatrixDoes) {
  PoseMatrix matrix(kUnknowns, pairs_);
  ASSERT_TRUE(matrix.Factorise(blocks_));
  const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(6 * kUnknowns, -1.0, 2.0);
  const Eigen::VectorXd x = matrix.Solve(right_side);
  EXPECT_LT((dense_ * x - right_side).norm(), 1e-10 * right_side.norm());
}

TEST_F(PoseMatrixTest, SolvesForSeveralRightSidesAtOnceAsForEach) {
  PoseMatrix matrix(kUnknowns, pairs_);
  ASSERT_TRUE(matrix.Factorise(blocks_));
  Eigen::MatrixXd right_sides(6 * kUnknowns, 3);
  right_sides << Eigen::VectorXd::LinSpaced(6 * kUnknowns, -1.0, 2.0),
      Eigen::VectorXd::Ones(6 * kUnknowns), Eigen::VectorXd::Unit(6 * kUnknowns, 7);
  const Eigen::MatrixXd x = matrix.Solve(right_sides);
  EXPECT_LT((dense_ * x - right_sides).norm(), 1e-10 * right_sides.norm());
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd of_one = matrix.Solve(Eigen::VectorXd(right_sides.col(i)));
    EXPECT_LT((x.col(i) - of_one).norm(), 1e-12 * of_one.norm());
  }
}

TEST_F(PoseMatrixTest, IsFactorisedAnewWithOtherBlocks) {
  PoseMatrix matrix(kUnknowns, pairs_);
  ASSERT_TRUE(matrix.Factorise(blocks_));
  const Eigen::VectorXd right_side = Eigen::VectorXd::Ones(6 * kUnknowns);
  const Eigen::VectorXd x = matrix.Solve(right_side);
  for (Matrix6d& block : blocks_) block *= 4.0;
  ASSERT_TRUE(matrix.Factorise(blocks_));
  EXPECT_LT((4.0 * matrix.Solve(right_side) - x).norm(), 1e-12 * x.norm());
}

TEST_F(PoseMatrixTest, TellsAMatrixThatIsNotPositiveDefinite) {
  blocks_.back()(5, 5) = -1.0;  // of the last diagonal block
  EXPECT_FALSE(PoseMatrix(kUnknowns, pairs_).Factorise(blocks_));
}

TEST_F(PoseMatrixTest, TakesPairsInAnyOrder) {
  PoseMatrix ordered(kUnknowns, pairs_);
  ASSERT_TRUE(ordered.Factorise(blocks_));
  std::reverse(pairs_.begin(), pairs_.end());
  std::reverse(blocks_.begin(), blocks_.end());
  PoseMatrix reversed(kUnknowns, pairs_);
  ASSERT_TRUE(reversed.Factorise(blocks_));
  const Eigen::VectorXd right_side = Eigen::VectorXd::Ones(6 * kUnknowns);
  EXPECT_EQ(ordered.Solve(right_side), reversed.Solve(right_side));
}

}  // namespace
}  // namespace rigmap
