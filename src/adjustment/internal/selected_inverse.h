// Blocks of the inverse of a sparse matrix, without the rest of it. Of this room only.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

// The 6 x 6 blocks on the diagonal of the inverse of the matrix that was factorised, which must
// have full blocks there. Takes the time of the factorisation: only entries where the factor has
// one are computed (Takahashi, Fagan and Chen 1973).
std::vector<Matrix6d> InverseDiagonalBlocks(
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor);

}  // namespace rigmap
