#include "adjustment/internal/pose_matrix.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace rigmap {

PoseMatrix::PoseMatrix(int unknowns, const std::vector<Pair>& pairs) {
  Order(unknowns, pairs);
  rows_.resize(unknowns);
  for (const auto& [column, row] : pairs) {
    const auto [first, second] = std::minmax(position_[column], position_[row]);
    if (first != second) rows_[first].push_back(second);
  }
  int slots = 0;
  for (int k = 0; k < unknowns; ++k) {
    std::vector<int>& rows = rows_[k];
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    first_.push_back(slots);
    slots += 1 + static_cast<int>(rows.size());
    // Eliminating a column fills its blocks into that of the first row below.
    if (!rows.empty()) {
      rows_[rows.front()].insert(rows_[rows.front()].end(), rows.begin() + 1, rows.end());
    }
  }
  factor_.resize(slots);
  for (const auto& [column, row] : pairs) {
    const int c = position_[column], r = position_[row];
    slot_of_pair_.push_back({SlotOf(std::min(c, r), std::max(c, r)), r < c});
  }
  ListUpdates();
}

void PoseMatrix::Order(int unknowns, const std::vector<Pair>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [column, row] : pairs) {
    entries.emplace_back(row, column, 1.0);
    if (row != column) entries.emplace_back(column, row, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(unknowns, unknowns);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  position_.resize(unknowns);
  for (int k = 0; k < unknowns; ++k) position_[order.indices()(k)] = k;
}

int PoseMatrix::SlotOf(int column, int row) const {
  if (row == column) return first_[column];
  const std::vector<int>& rows = rows_[column];
  return first_[column] + 1 +
         static_cast<int>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
}

void PoseMatrix::ListUpdates() {
  for (const std::vector<int>& rows : rows_) {
    for (std::size_t a = 0; a < rows.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) updates_.push_back(SlotOf(rows[b], rows[a]));
    }
  }
}

bool PoseMatrix::Factorise(const std::vector<Matrix6d>& blocks) {
  std::fill(factor_.begin(), factor_.end(), Matrix6d::Zero());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto [index, transposed] = slot_of_pair_[i];
    if (transposed) {
      factor_[index] = blocks[i].transpose();
    } else {
      factor_[index] = blocks[i];
    }
  }
  // Rows of a column change blocks of their own, so that each thread sums in the same order as one.
  constexpr std::size_t kRowsTogether = 16;  // 136 products and more, some ten microseconds
  const int* updates = updates_.data();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    Matrix6d& diagonal = factor_[first_[k]];
    const Eigen::LLT<Matrix6d> root(diagonal);
    if (root.info() != Eigen::Success) return false;
    diagonal = root.matrixL().solve(Matrix6d::Identity());
    Matrix6d* below = &diagonal + 1;
    const std::size_t count = rows_[k].size();
    for (std::size_t a = 0; a < count; ++a) below[a] = (below[a] * diagonal.transpose()).eval();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kRowsTogether),
                      [&](const auto& rows) {
                        for (std::size_t a = rows.begin(); a < rows.end(); ++a) {
                          const int* update = updates + a * (a + 1) / 2;
                          for (std::size_t b = 0; b <= a; ++b) {
                            factor_[*update++].noalias() -= below[a] * below[b].transpose();
                          }
                        }
                      });
    updates += count * (count + 1) / 2;
  }
  return true;
}

template <class Matrix>
Matrix PoseMatrix::SolveAny(const Matrix& right_sides) const {
  const int unknowns = static_cast<int>(rows_.size());
  Matrix x(right_sides.rows(), right_sides.cols());
  const auto rows_of = [](auto& matrix, int k) { return matrix.template middleRows<6>(6 * k); };
  using Rows = Eigen::Matrix<double, 6, Matrix::ColsAtCompileTime>;
  for (int i = 0; i < unknowns; ++i) rows_of(x, position_[i]) = rows_of(right_sides, i);
  for (int k = 0; k < unknowns; ++k) {
    const Matrix6d* column = &factor_[first_[k]];
    const Rows at = *column * rows_of(x, k);
    rows_of(x, k) = at;
    for (const int row : rows_[k]) rows_of(x, row).noalias() -= *++column * at;
  }
  for (int k = unknowns - 1; k >= 0; --k) {
    const Matrix6d* column = &factor_[first_[k]];
    Rows at = rows_of(x, k);
    for (std::size_t a = 0; a < rows_[k].size(); ++a) {
      at.noalias() -= column[a + 1].transpose() * rows_of(x, rows_[k][a]);
    }
    rows_of(x, k).noalias() = column->transpose() * at;
  }
  Matrix result(right_sides.rows(), right_sides.cols());
  for (int i = 0; i < unknowns; ++i) rows_of(result, i) = rows_of(x, position_[i]);
  return result;
}

Eigen::VectorXd PoseMatrix::Solve(const Eigen::VectorXd& right_side) const {
  return SolveAny(right_side);
}

Eigen::MatrixXd PoseMatrix::Solve(const Eigen::MatrixXd& right_sides) const {
  return SolveAny(right_sides);
}

}  // namespace rigmap
