#include "correspondence/internal/pose_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace rigmap {
namespace {

Eigen::Matrix<double, 2, 3> ProjectionJacobian(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 2, 3> j;
  j << 1.0 / x.z(), 0.0, -x.x() / (x.z() * x.z()), 0.0, 1.0 / x.z(), -x.y() / (x.z() * x.z());
  return j;
}

}  // namespace

double DepthShare(const PointSighting& sighting) {
  return sighting.depth_sigma_m / sighting.x_in_reference.norm();
}

PoseProblem::PoseProblem(std::span<const PointSighting> sightings, const StereoRig& rig,
                         const StereoPoseOptions& options)
    : sightings_(sightings),
      rig_(rig),
      right_turn_(rig.right_from_left.rotation.toRotationMatrix()),
      options_(options),
      noise_(options.noise_px / rig.left.camera.MeanFocal()),
      reference_noise_(options.reference_noise_px / rig.left.camera.MeanFocal()) {}

std::optional<PoseProblem::Linearised> PoseProblem::Linearise(const PointSighting& sighting,
                                                              const Rigid3& motion) const {
  const Eigen::Vector3d in_left = motion * sighting.x_in_reference;
  const Eigen::Vector3d in_right = rig_.right_from_left * in_left;
  if (!(in_left.z() > 0.0) || !(in_right.z() > 0.0)) return std::nullopt;
  const Eigen::Vector3d ray = sighting.x_in_reference.normalized() * sighting.depth_sigma_m;
  const Eigen::Vector3d depth_step = motion.rotation * ray;
  const Eigen::Matrix<double, 3, 2> keypoint_step =
      reference_noise_ * sighting.x_in_reference.z() *
      motion.rotation.toRotationMatrix().leftCols<2>();
  Eigen::Matrix<double, 3, 6> motion_jacobian;
  motion_jacobian << Eigen::Matrix3d::Identity(), -Skew(in_left);
  if (DepthShare(sighting) > kKnownShare) motion_jacobian.leftCols<3>().setZero();
  Linearised result;
  const Eigen::Matrix<double, 2, 3> left = ProjectionJacobian(in_left);
  result.residual.head<2>() = in_left.hnormalized() - sighting.left;
  result.jacobian.topRows<2>() = left * motion_jacobian;
  result.depth_response.head<2>() = left * depth_step;
  result.keypoint_response.topRows<2>() = left * keypoint_step;
  if (sighting.right) {
    const Eigen::Matrix<double, 2, 3> right =
        ProjectionJacobian(in_right) * rig_.right_from_left.rotation.toRotationMatrix();
    result.residual.tail<2>() = in_right.hnormalized() - *sighting.right;
    result.jacobian.bottomRows<2>() = right * motion_jacobian;
    result.depth_response.tail<2>() = right * depth_step;
    result.keypoint_response.bottomRows<2>() = right * keypoint_step;
  }
  return result;
}

// Inverse covariance of the residual, by Sherman and Morrison, which bears responses of any size:
// points may come to lie beside a camera.
Eigen::Matrix4d PoseProblem::Information(const Linearised& at) const {
  Eigen::Matrix4d information = Eigen::Matrix4d::Identity() / (noise_ * noise_);
  const auto add = [&](const Vector4& response) {
    const Vector4 scaled = information * response;
    information -= scaled * scaled.transpose() / (1.0 + response.dot(scaled));
  };
  add(at.depth_response);
  if (reference_noise_ > 0.0) {
    for (const Vector4 response : at.keypoint_response.colwise()) add(response);
  }
  return information;
}

double PoseProblem::SquaredSigmas(const PointSighting& sighting, const Rigid3& motion) const {
  return SquaredSigmas(sighting, motion, motion.rotation.toRotationMatrix());
}

double PoseProblem::Cost(const Rigid3& motion, double enough) const {
  const Eigen::Matrix3d turn = motion.rotation.toRotationMatrix();
  double cost = 0.0;
  for (const auto& sighting : sightings_) {
    cost += std::min(SquaredSigmas(sighting, motion, turn), MaxSquared());
    if (cost >= enough) break;
  }
  return cost;
}

// Depths of the reference's points and the right eye's sightings answer to an offset together.
OffsetEffect PoseProblem::OffsetOf(const Rigid3& motion) const {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d mixed = Vector6d::Zero(), gradient = Vector6d::Zero();
  double own = 0.0, along = 0.0;
  ForEachWithin(
      MaxSquared(), motion,
      [&](const PointSighting& sighting, const Linearised& at, const Eigen::Matrix4d& weight) {
        const Vector4 response = OffsetResponse(sighting, motion);
        normal += at.jacobian.transpose() * weight * at.jacobian;
        mixed += at.jacobian.transpose() * weight * response;
        gradient += at.jacobian.transpose() * weight * at.residual;
        own += response.dot(weight * response);
        along += response.dot(weight * at.residual);
      });
  const Eigen::LDLT<Matrix6d> solver(normal);
  const Vector6d following = -solver.solve(mixed);
  const double length_m = motion.translation.norm();
  if (!following.allFinite() || !(length_m > 0.0)) return {};
  return {.lengthening_m_per_px = motion.translation.dot(following.head<3>()) / length_m,
          .score = -(along + following.dot(gradient)),
          .information = own + following.dot(mixed)};
}

// One iteratively reweighted Gauss-Newton step over sightings within the gate, with Huber
// weights; returns the normal matrix, or nothing if it is singular.
std::optional<Matrix6d> PoseProblem::Step(double gate_squared, Rigid3& motion) const {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  ForEachWithin(gate_squared, motion,
                [&](const PointSighting&, const Linearised& at, const Eigen::Matrix4d& weight) {
                  normal += at.jacobian.transpose() * weight * at.jacobian;
                  gradient += at.jacobian.transpose() * weight * at.residual;
                });
  const Eigen::LDLT<Matrix6d> solver(normal);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-14)) return std::nullopt;
  const Vector6d step = -solver.solve(gradient);
  if (!step.allFinite()) return std::nullopt;
  motion = Rigid3{ExpRotation(step.tail<3>()), step.head<3>()} * motion;
  return normal;
}

std::optional<Matrix6d> PoseProblem::Refine(Rigid3& motion) const {
  std::optional<Matrix6d> normal;
  for (const double widen : {9.0, 4.0, 1.0, 1.0, 1.0, 1.0}) {
    normal = Step(widen * MaxSquared(), motion);
    if (!normal) return std::nullopt;
  }
  return normal;
}

StereoPose PoseProblem::Judge(const Rigid3& motion, const Matrix6d& normal) const {
  StereoPose result{
      .current_from_reference = motion, .covariance = normal.inverse(), .offset = OffsetOf(motion)};
  for (const auto& sighting : sightings_) {
    const bool inlier = SquaredSigmas(sighting, motion) <= MaxSquared();
    result.inliers.push_back(inlier);
    result.inlier_count += inlier ? 1 : 0;
  }
  return result;
}

// Calls `use` for each sighting within the gate, linearised, with its information times its
// Huber weight.
template <class Use>
void PoseProblem::ForEachWithin(double gate_squared, const Rigid3& motion, const Use& use) const {
  constexpr double kHuberSigmas = 1.5;
  for (const auto& sighting : sightings_) {
    const auto at = Linearise(sighting, motion);
    if (!at) continue;
    const Eigen::Matrix4d information = Information(*at);
    const double squared =
        at->residual.dot(information * at->residual) / (sighting.right ? 2.0 : 1.0);
    if (squared > gate_squared) continue;
    const double weight = std::min(1.0, kHuberSigmas / std::sqrt(std::max(squared, 1e-12)));
    use(sighting, *at, weight * information);
  }
}

// Of the residual, if a pixel of offset were taken from both frames' disparities.
PoseProblem::Vector4 PoseProblem::OffsetResponse(const PointSighting& sighting,
                                                 const Rigid3& motion) const {
  const double radians = 1.0 / rig_.left.camera.MeanFocal();
  const Eigen::Vector3d in_left = motion * sighting.x_in_reference;
  const Eigen::Vector3d farther = motion.rotation * sighting.x_in_reference *
                                  (sighting.x_in_reference.z() * radians / rig_.Baseline());
  Vector4 response = Vector4::Zero();
  response.head<2>() = ProjectionJacobian(in_left) * farther;
  if (sighting.right) {
    const Eigen::Vector3d in_right = rig_.right_from_left * in_left;
    response.tail<2>() = ProjectionJacobian(in_right) * (right_turn_ * farther) +
                         radians * rig_.right_from_left.translation.head<2>().normalized();
  }
  return response;
}

// `turn` is that of `motion`. Where only the depth is shared, without the matrices of Linearise
// and Information: samples by the hundred ask for nothing else.
double PoseProblem::SquaredSigmas(const PointSighting& sighting, const Rigid3& motion,
                                  const Eigen::Matrix3d& turn) const {
  if (reference_noise_ > 0.0) {
    const auto at = Linearise(sighting, motion);
    if (!at) return std::numeric_limits<double>::infinity();
    return at->residual.dot(Information(*at) * at->residual) / (sighting.right ? 2.0 : 1.0);
  }
  const Eigen::Vector3d turned = turn * sighting.x_in_reference;
  const Eigen::Vector3d in_left = turned + motion.translation;
  const Eigen::Vector3d in_right = right_turn_ * in_left + rig_.right_from_left.translation;
  if (!(in_left.z() > 0.0) || !(in_right.z() > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector3d depth_step =
      turned * (sighting.depth_sigma_m / sighting.x_in_reference.norm());
  double square = 0.0, along = 0.0, response = 0.0;
  const auto add = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& step,
                       const Eigen::Vector2d& seen) {
    const Eigen::Vector2d at = x.head<2>() / x.z();
    const Eigen::Vector2d residual = at - seen, d = (step.head<2>() - at * step.z()) / x.z();
    square += residual.squaredNorm();
    along += residual.dot(d);
    response += d.squaredNorm();
  };
  add(in_left, depth_step, sighting.left);
  if (sighting.right) add(in_right, right_turn_ * depth_step, *sighting.right);
  const double variance = noise_ * noise_;
  return (square - along * along / (variance + response)) / variance / (sighting.right ? 2.0 : 1.0);
}

}  // namespace rigmap
