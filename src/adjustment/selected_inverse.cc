#include "adjustment/internal/selected_inverse.h"

#include <algorithm>

namespace rigmap {
namespace {

using SparseFactor = Eigen::SparseMatrix<double>;

// With P A P' = L D L', the inverse Z of P A P' fulfils Z = inv(D) inv(L) + (I - L') Z. From the
// last column to the first, its entries on L's pattern need only each other.
class SelectedInverse {
 public:
  SelectedInverse(const SparseFactor& strict_lower, const Eigen::VectorXd& diagonal)
      : lower_(strict_lower),
        below_(static_cast<std::size_t>(strict_lower.nonZeros())),
        diagonal_(diagonal.cwiseInverse()) {
    for (int column = static_cast<int>(diagonal.size()) - 1; column >= 0; --column) {
      FillColumn(column);
    }
  }

  double At(int row, int column) const {
    if (row == column) return diagonal_(row);
    if (row < column) std::swap(row, column);
    const int* end = Rows(column + 1);
    const int* found = std::lower_bound(Rows(column), end, row);
    return found != end && *found == row ? below_[Index(found)] : 0.0;
  }

 private:
  const int* Rows(int column) const {
    return lower_.innerIndexPtr() + lower_.outerIndexPtr()[column];
  }
  std::size_t Index(const int* row) const {
    return static_cast<std::size_t>(row - lower_.innerIndexPtr());
  }

  void FillColumn(int column) {
    const int *begin = Rows(column), *end = Rows(column + 1);
    std::fill(below_.begin() + (begin - Rows(0)), below_.begin() + (end - Rows(0)), 0.0);
    for (const int* b = begin; b != end; ++b) {
      const double l_b = lower_.valuePtr()[Index(b)];
      below_[Index(b)] -= l_b * diagonal_(*b);
      // Column *b of Z holds every further row of this column.
      const int* row = Rows(*b);
      for (const int* a = b + 1; a != end; ++a) {
        while (*row != *a) ++row;
        const double z = below_[Index(row)];
        below_[Index(a)] -= l_b * z;
        below_[Index(b)] -= lower_.valuePtr()[Index(a)] * z;
      }
    }
    for (const int* b = begin; b != end; ++b) {
      diagonal_(column) -= lower_.valuePtr()[Index(b)] * below_[Index(b)];
    }
  }

  const SparseFactor& lower_;
  std::vector<double> below_;  // of Z, at L's entries
  Eigen::VectorXd diagonal_;
};

}  // namespace

std::vector<Matrix6d> InverseDiagonalBlocks(
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor) {
  const SparseFactor lower = factor.matrixL().nestedExpression();
  const SelectedInverse inverse(lower, factor.vectorD());
  const auto& order = factor.permutationP().indices();
  const auto permuted = [&](int row) { return order.size() > 0 ? order(row) : row; };
  std::vector<Matrix6d> blocks(static_cast<std::size_t>(lower.cols() / 6));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const int first = 6 * static_cast<int>(i);
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) {
        blocks[i](r, c) = inverse.At(permuted(first + r), permuted(first + c));
      }
    }
  }
  return blocks;
}

}  // namespace rigmap
