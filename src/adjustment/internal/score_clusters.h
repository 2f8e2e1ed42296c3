// How sure a least-squares solution is when its residuals are not independent. Of this room only.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

// Scores (gradients of the objective by the unknown poses) in clusters, within which residuals may
// go together in any way, while those of different clusters are independent. With the normal matrix
// N and the sum G of the clusters' outer products the covariance is N^-1 G N^-1 (Liang and Zeger
// 1986, eq. 10).
class ScoreClusters {
 public:
  using Score = std::pair<int, Vector6d>;  // number of the unknown pose, gradient

  // One cluster; no unknown pose twice.
  void Add(std::vector<Score> poses) { clusters_.push_back(std::move(poses)); }

  void Append(ScoreClusters further) {
    std::ranges::move(further.clusters_, std::back_inserter(clusters_));
  }

  // The block of the covariance that belongs to one unknown pose, given the six columns of N^-1
  // that do (6 rows for each unknown).
  Matrix6d Covariance(const Eigen::MatrixXd& columns_of_inverse) const;

 private:
  std::vector<std::vector<Score>> clusters_;
};

}  // namespace rigmap
