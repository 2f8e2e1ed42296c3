#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "adjustment/calibration.h"

namespace rigmap {

std::optional<CalibrationStep> RotationAndFocalStep(const CalibrationEquations& equations) {
  const Eigen::Matrix4d information = equations.information.topLeftCorner<4, 4>();
  const Eigen::LDLT<Eigen::Matrix4d> solver(information);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return std::nullopt;
  const Eigen::Matrix4d inverse = information.inverse();
  const Eigen::Matrix4d found =
      inverse * equations.score_covariance.topLeftCorner<4, 4>() * inverse;
  const Eigen::Vector4d step = inverse * equations.score.head<4>();
  const Eigen::Vector4d independent = inverse.diagonal().cwiseSqrt();
  const Eigen::Vector4d sigma = independent.cwiseMax(found.diagonal().cwiseSqrt());
  if (!step.allFinite() || !(independent.minCoeff() > 0.0)) return std::nullopt;
  const Eigen::Matrix3d correlation = inverse.topLeftCorner<3, 3>().cwiseQuotient(
      independent.head<3>() * independent.head<3>().transpose());
  return CalibrationStep{step.head<3>(), sigma.head<3>(), independent.head<3>(), correlation,
                         step(3),        sigma(3),        independent(3)};
}

}  // namespace rigmap
