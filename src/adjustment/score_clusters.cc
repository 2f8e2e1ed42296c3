#include "adjustment/internal/score_clusters.h"

namespace rigmap {

Matrix6d ScoreClusters::Covariance(const Eigen::MatrixXd& columns_of_inverse) const {
  Matrix6d covariance = Matrix6d::Zero();
  for (const Cluster& cluster : clusters_) {
    Vector6d moved = Vector6d::Zero();
    for (const auto& [unknown, score] : cluster.poses) {
      moved += columns_of_inverse.middleRows<6>(6 * unknown).transpose() * score;
    }
    covariance += moved * moved.transpose();
  }
  return covariance;
}

CalibrationMatrix ScoreClusters::CalibrationCovariance(const Eigen::MatrixXd& coupled) const {
  CalibrationMatrix covariance = CalibrationMatrix::Zero();
  for (const Cluster& cluster : clusters_) {
    CalibrationVector score = cluster.calibration;
    for (const auto& [unknown, of_pose] : cluster.poses) {
      score -= coupled.middleRows<6>(6 * unknown).transpose() * of_pose;
    }
    covariance += score * score.transpose();
  }
  return covariance;
}

}  // namespace rigmap
