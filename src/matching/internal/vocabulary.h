// Visual words: descriptors told apart by a tree of means, learned from the part's own.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "scene/features.h"

namespace rigmap {

// Hierarchical k-means (Nister and Stewenius 2006) over RootSIFT (Arandjelovic and Zisserman 2012).
// Equal samples give equal trees.
class Vocabulary {
 public:
  static constexpr int kBranches = 16;  // children of a node
  static constexpr int kLevels = 4;     // at most 65536 words

  // A node is split as long as it holds more than kBranches of the sample. Cost: 2 us for each
  // descriptor of the sample and level. An empty sample gives one word.
  explicit Vocabulary(std::span<const Descriptor> sample);

  // The leaf of the tree that a descriptor falls into. About 1 us.
  int WordOf(const Descriptor& descriptor) const;
  // The child of the root above that leaf; 0 where there is none.
  int BranchOf(const Descriptor& descriptor) const;
  int word_count() const { return word_count_; }

 private:
  using Vectors = Eigen::Matrix<float, Eigen::Dynamic, kDescriptorSize, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<float, 1, kDescriptorSize>;
  using Means = Eigen::Matrix<float, kBranches, kDescriptorSize, Eigen::RowMajor>;
  struct Node {
    Means means = Means::Zero();  // one row per child
    Eigen::Matrix<float, kBranches, 1> half_squared_norms;
    std::vector<int> children;  // nodes, or -1 - word
  };
  // Makes the node over these rows of `sample`; returns its index, or -1 - word for a leaf.
  int Grow(const Vectors& sample, const std::vector<int>& rows, int level);
  static Vector RootSift(const Descriptor& descriptor);
  // Of each of the rows.
  static std::vector<int> NearestOf(const Node& node, const Vectors& sample,
                                    const std::vector<int>& rows);
  static int Nearest(const Node& node, const Vector& vector);
  static Node Cluster(const Vectors& sample, const std::vector<int>& rows);

  std::vector<Node> nodes_;
  int root_ = 0;
  int word_count_ = 0;
};

}  // namespace rigmap
