// Blocks of the inverse of a sparse matrix, without the rest of it. Of this room only.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

// Of a matrix of 6 x 6 blocks that was factorised, full ones on the diagonal among them: those
// entries of the inverse where the factor has one, in the time of the factorisation (Takahashi,
// Fagan and Chen 1973).
class SelectedInverse {
 public:
  using SparseMatrix = Eigen::SparseMatrix<double>;
  explicit SelectedInverse(const Eigen::SimplicialLDLT<SparseMatrix>& factor);

  // Of rows and columns of blocks, where the matrix itself has a block.
  Matrix6d Block(int row, int column) const;

 private:
  double At(int row, int column) const;
  void FillColumn(int column);
  const int* Rows(int column) const;
  std::size_t Index(const int* row) const;

  SparseMatrix lower_;  // strictly
  Eigen::VectorXi order_;
  std::vector<double> below_;  // of the inverse, at the factor's entries
  Eigen::VectorXd diagonal_;
};

}  // namespace rigmap
