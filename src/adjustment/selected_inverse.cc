#include "adjustment/internal/selected_inverse.h"

#include <algorithm>

namespace rigmap {

// With P A P' = L D L', the inverse Z of P A P' fulfils Z = inv(D) inv(L) + (I - L') Z. From the
// last column to the first, its entries on L's pattern need only each other.
SelectedInverse::SelectedInverse(const Eigen::SimplicialLDLT<SparseMatrix>& factor)
    : lower_(factor.matrixL().nestedExpression()),
      order_(factor.permutationP().indices()),
      below_(static_cast<std::size_t>(lower_.nonZeros())),
      diagonal_(factor.vectorD().cwiseInverse()) {
  for (int column = static_cast<int>(diagonal_.size()) - 1; column >= 0; --column) {
    FillColumn(column);
  }
}

Matrix6d SelectedInverse::Block(int row, int column) const {
  const auto permuted = [&](int i) { return order_.size() > 0 ? order_(i) : i; };
  Matrix6d block;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) block(r, c) = At(permuted(6 * row + r), permuted(6 * column + c));
  }
  return block;
}

double SelectedInverse::At(int row, int column) const {
  if (row == column) return diagonal_(row);
  if (row < column) std::swap(row, column);
  const int* end = Rows(column + 1);
  const int* found = std::lower_bound(Rows(column), end, row);
  return found != end && *found == row ? below_[Index(found)] : 0.0;
}

void SelectedInverse::FillColumn(int column) {
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

const int* SelectedInverse::Rows(int column) const {
  return lower_.innerIndexPtr() + lower_.outerIndexPtr()[column];
}

std::size_t SelectedInverse::Index(const int* row) const {
  return static_cast<std::size_t>(row - lower_.innerIndexPtr());
}

}  // namespace rigmap
