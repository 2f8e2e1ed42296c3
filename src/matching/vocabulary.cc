#include "matching/internal/vocabulary.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rigmap {
namespace {

constexpr int kIterations = 4;  // more hardly move the means, and words need not be optimal

}  // namespace

// Square roots of the descriptor's shares: Euclidean distance is then Hellinger's.
Vocabulary::Vector Vocabulary::RootSift(const Descriptor& descriptor) {
  Vector root;
  float sum = 0.0F;
  for (const std::uint8_t value : descriptor) sum += value;
  for (int i = 0; i < kDescriptorSize; ++i) {
    root[i] = std::sqrt(static_cast<float>(descriptor[i]) / std::max(sum, 1.0F));
  }
  return root;
}

Vocabulary::Vocabulary(std::span<const Descriptor> sample) {
  Vectors vectors(sample.size(), kDescriptorSize);
  std::vector<int> rows;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    rows.push_back(static_cast<int>(i));
    vectors.row(rows.back()) = RootSift(sample[i]);
  }
  root_ = Grow(vectors, rows, 0);
}

int Vocabulary::WordOf(const Descriptor& descriptor) const {
  const Vector vector = RootSift(descriptor);
  int node = root_;
  while (node >= 0) node = nodes_[node].children[Nearest(nodes_[node], vector)];
  return -1 - node;
}

int Vocabulary::BranchOf(const Descriptor& descriptor) const {
  return root_ < 0 ? 0 : Nearest(nodes_[root_], RootSift(descriptor));
}

int Vocabulary::Grow(const Vectors& sample, const std::vector<int>& rows, int level) {
  if (level == kLevels || static_cast<int>(rows.size()) <= kBranches) return -1 - word_count_++;
  Node node = Cluster(sample, rows);
  std::vector<std::vector<int>> parts(kBranches);
  const std::vector<int> nearest = NearestOf(node, sample, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) parts[nearest[i]].push_back(rows[i]);
  // Twins that no means tell apart would be split for ever.
  for (const auto& part : parts) {
    if (part.size() == rows.size()) return -1 - word_count_++;
  }
  const auto index = nodes_.size();
  nodes_.emplace_back();
  for (const auto& part : parts) node.children.push_back(Grow(sample, part, level + 1));
  nodes_[index] = std::move(node);
  return static_cast<int>(index);
}

int Vocabulary::Nearest(const Node& node, const Vector& vector) {
  // |x - m|^2 is least where x m - m^2 / 2 is largest.
  Eigen::Matrix<float, kBranches, 1> likeness = -node.half_squared_norms;
  for (int k = 0; k < kBranches; ++k) likeness[k] += node.means.row(k).dot(vector);
  Eigen::Index best = 0;
  likeness.maxCoeff(&best);
  return static_cast<int>(best);
}

std::vector<int> Vocabulary::NearestOf(const Node& node, const Vectors& sample,
                                       const std::vector<int>& rows) {
  std::vector<int> nearest(rows.size());
  tbb::parallel_for(std::size_t{0}, rows.size(),
                    [&](std::size_t i) { nearest[i] = Nearest(node, sample.row(rows[i])); });
  return nearest;
}

Vocabulary::Node Vocabulary::Cluster(const Vectors& sample, const std::vector<int>& rows) {
  Node node;
  // Rows spread over the sample, which is in no order of appearance.
  for (int k = 0; k < kBranches; ++k) {
    node.means.row(k) = sample.row(rows[rows.size() * static_cast<std::size_t>(k) / kBranches]);
  }
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    node.half_squared_norms = 0.5F * node.means.rowwise().squaredNorm();
    if (iteration == kIterations) break;
    Means sums = Means::Zero();
    std::array<float, kBranches> counts{};
    const std::vector<int> nearest = NearestOf(node, sample, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      sums.row(nearest[i]) += sample.row(rows[i]);
      counts[nearest[i]] += 1.0F;
    }
    for (int k = 0; k < kBranches; ++k) {
      if (counts[k] > 0.0F) node.means.row(k) = sums.row(k) / counts[k];
    }
  }
  return node;
}

}  // namespace rigmap
