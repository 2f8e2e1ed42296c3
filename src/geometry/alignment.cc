#include "geometry/alignment.h"

#include <Eigen/SVD>
#include <stdexcept>

namespace rigmap {

Sim3 AlignPoints(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                 bool with_scale) {
  if (from.size() != to.size() || from.size() < 3) {
    throw std::invalid_argument("AlignPoints needs two lists of equal size, at least 3 points");
  }
  const double count = static_cast<double>(from.size());
  Eigen::Vector3d from_mean = Eigen::Vector3d::Zero(), to_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    from_mean += from[i] / count;
    to_mean += to[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double from_variance = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (to[i] - to_mean) * (from[i] - from_mean).transpose() / count;
    from_variance += (from[i] - from_mean).squaredNorm() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) sign.z() = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  Sim3 result;
  result.rotation = Eigen::Quaterniond(rotation).normalized();
  if (with_scale && from_variance > 0.0) {
    result.scale = svd.singularValues().dot(sign) / from_variance;
  }
  result.translation = to_mean - result.scale * (result.rotation * from_mean);
  return result;
}

}  // namespace rigmap
