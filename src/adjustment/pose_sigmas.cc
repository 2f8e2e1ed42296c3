#include "adjustment/internal/pose_sigmas.h"

namespace rigmap {
namespace {

// Sigmas grown along and about the left camera's axes, correlations kept.
Matrix6d Inflated(const Matrix6d& covariance, const Rigid3& left_from_world,
                  const Vector6d& inflation, double shared_noise) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      left_from_world.rotation.toRotationMatrix();
  const Matrix6d grow = shared_noise * turn.transpose() * inflation.asDiagonal() * turn;
  return grow * covariance * grow.transpose();
}

}  // namespace

std::vector<Matrix6d> InflatedCovariances(const CameraSystemResult& system,
                                          const std::vector<std::optional<Rigid3>>& left_from_world,
                                          double shared_noise,
                                          const CalibrationMatrix& of_calibration) {
  std::vector<Matrix6d> covariances = system.covariances;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    if (!left_from_world[i]) continue;
    covariances[i] =
        Inflated(covariances[i], *left_from_world[i], system.inflations[i], shared_noise);
    if (system.by_calibration.empty()) continue;
    covariances[i] +=
        system.by_calibration[i] * of_calibration * system.by_calibration[i].transpose();
  }
  return covariances;
}

std::vector<std::optional<Matrix6d>> InflatedLinks(
    const CameraSystemResult& system, const std::vector<std::optional<Rigid3>>& left_from_world,
    double shared_noise) {
  std::vector<std::optional<Matrix6d>> links = system.link_covariances;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i])
      links[i] = Inflated(*links[i], *left_from_world[i], system.inflations[i], shared_noise);
  }
  return links;
}

}  // namespace rigmap
