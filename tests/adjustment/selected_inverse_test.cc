#include "adjustment/internal/selected_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/seeded_random.h"

namespace rigmap {
namespace {

// Positive definite with full blocks on the diagonal and some beside it.
Eigen::MatrixXd RandomSystem(int blocks, double density, SeededRandom& random) {
  const int size = 6 * blocks;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (int a = 0; a < blocks; ++a) {
    for (int b = 0; b <= a; ++b) {
      const bool linked = a == b || a == b + 1 || random.Uniform(0.0, 1.0) < density;
      if (!linked) continue;
      for (int i = 0; i < 36; ++i) {
        const double value = random.Uniform(-1.0, 1.0);
        matrix(6 * a + i / 6, 6 * b + i % 6) = value;
        matrix(6 * b + i % 6, 6 * a + i / 6) = value;
      }
    }
  }
  matrix.diagonal().array() += 1.0 + matrix.cwiseAbs().rowwise().sum().maxCoeff();
  return matrix;
}

TEST(SelectedInverse, BlocksAreThoseOfTheDenseInverse) {
  SeededRandom random;
  for (int blocks : {1, 2, 7, 20}) {
    for (double density : {0.0, 0.1, 0.5}) {
      const Eigen::MatrixXd matrix = RandomSystem(blocks, density, random);
      const Eigen::SparseMatrix<double> lower =
          Eigen::MatrixXd(matrix.triangularView<Eigen::Lower>()).sparseView();
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(lower);
      ASSERT_EQ(factor.info(), Eigen::Success);
      const Eigen::MatrixXd inverse = matrix.inverse();
      const SelectedInverse found(factor);
      for (int i = 0; i < 36 * blocks * blocks; i += 36) {
        const int row = i / 36 / blocks, column = i / 36 % blocks;
        if (matrix.block<6, 6>(6 * row, 6 * column).isZero()) continue;
        const Matrix6d expected = inverse.block<6, 6>(6 * row, 6 * column);
        // Off the diagonal little is left of what is added up.
        const double scale = row == column ? expected.norm() : inverse.norm();
        EXPECT_LT((found.Block(row, column) - expected).norm(), 1e-12 * scale);
      }
    }
  }
}

}  // namespace
}  // namespace rigmap
