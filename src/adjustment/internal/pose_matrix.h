// A sparse symmetric matrix of 6 x 6 blocks, one row of them per unknown pose. Of this room only.
#pragma once

#include <utility>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

// Factorised block by block (Cholesky), rows in an order that leaves few blocks to fill in. Which
// blocks meet is worked out once, for matrices with blocks in the same places.
class PoseMatrix {
 public:
  using Pair = std::pair<int, int>;  // column and row of a block, the row not less than the column

  // Where blocks are: each pair once, those of the diagonal all among them.
  PoseMatrix(int unknowns, const std::vector<Pair>& pairs);

  // Takes a block for each pair. False where the matrix is not positive definite.
  bool Factorise(const std::vector<Matrix6d>& blocks);
  // 6 rows for each unknown; any number of right sides next to each other.
  Eigen::VectorXd Solve(const Eigen::VectorXd& right_side) const;
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& right_sides) const;

 private:
  struct Slot {
    int index = 0;
    bool transposed = false;
  };
  void Order(int unknowns, const std::vector<Pair>& pairs);
  void ListUpdates();
  int SlotOf(int column, int row) const;
  template <class Matrix>
  Matrix SolveAny(const Matrix& right_sides) const;

  std::vector<int> position_;           // of each unknown in the order of elimination
  std::vector<std::vector<int>> rows_;  // of each column's blocks below the diagonal, ascending
  std::vector<int> first_;              // slot of each column's diagonal block; others follow
  std::vector<Slot> slot_of_pair_;
  std::vector<int> updates_;      // slot that each two blocks of each column change, in order
  std::vector<Matrix6d> factor_;  // per slot; of diagonal blocks the inverse
};

}  // namespace rigmap
