#include "adjustment/internal/score_clusters.h"

namespace rigmap {

Matrix6d ScoreClusters::Covariance(const Eigen::MatrixXd& columns_of_inverse) const {
  Matrix6d covariance = Matrix6d::Zero();
  for (const std::vector<Score>& cluster : clusters_) {
    Vector6d moved = Vector6d::Zero();
    for (const auto& [unknown, score] : cluster) {
      moved += columns_of_inverse.middleRows<6>(6 * unknown).transpose() * score;
    }
    covariance += moved * moved.transpose();
  }
  return covariance;
}

}  // namespace rigmap
