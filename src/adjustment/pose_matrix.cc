#include "adjustment/internal/pose_matrix.h"

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
  const int* update = updates_.data();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    Matrix6d& diagonal = factor_[first_[k]];
    const Eigen::LLT<Matrix6d> root(diagonal);
    if (root.info() != Eigen::Success) return false;
    diagonal = root.matrixL().solve(Matrix6d::Identity());
    Matrix6d* below = &diagonal + 1;
    for (std::size_t a = 0; a < rows_[k].size(); ++a) {
      below[a] = (below[a] * diagonal.transpose()).eval();
      for (std::size_t b = 0; b <= a; ++b) {
        factor_[*update++].noalias() -= below[a] * below[b].transpose();
      }
    }
  }
  return true;
}

Eigen::VectorXd PoseMatrix::Solve(const Eigen::VectorXd& right_side) const {
  const int unknowns = static_cast<int>(rows_.size());
  Eigen::VectorXd x(right_side.size());
  for (int i = 0; i < unknowns; ++i) {
    x.segment<6>(6 * position_[i]) = right_side.segment<6>(6 * i);
  }
  for (int k = 0; k < unknowns; ++k) {
    const Matrix6d* column = &factor_[first_[k]];
    const Vector6d at = *column * x.segment<6>(6 * k);
    x.segment<6>(6 * k) = at;
    for (const int row : rows_[k]) x.segment<6>(6 * row) -= *++column * at;
  }
  for (int k = unknowns - 1; k >= 0; --k) {
    const Matrix6d* column = &factor_[first_[k]];
    Vector6d at = x.segment<6>(6 * k);
    for (std::size_t a = 0; a < rows_[k].size(); ++a) {
      at -= column[a + 1].transpose() * x.segment<6>(6 * rows_[k][a]);
    }
    x.segment<6>(6 * k) = column->transpose() * at;
  }
  Eigen::VectorXd result(right_side.size());
  for (int i = 0; i < unknowns; ++i) {
    result.segment<6>(6 * i) = x.segment<6>(6 * position_[i]);
  }
  return result;
}

}  // namespace rigmap
