#include "adjustment/reprojection_cost.h"

#include <ceres/sized_cost_function.h>

#include <algorithm>

#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class MotionManifold : public ceres::Manifold {
 public:
  explicit MotionManifold(bool turns_only) : turns_only_(turns_only) {}
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return turns_only_ ? 3 : 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Rigid3 motion = FromBlock(x);
    const Eigen::Quaterniond turn = ExpRotation(Eigen::Map<const Eigen::Vector3d>(delta));
    Rigid3 moved{(turn * motion.rotation).normalized(), motion.translation};
    if (turns_only_) {
      moved.translation = turn * motion.translation;
    } else {
      moved.translation += Eigen::Map<const Eigen::Vector3d>(delta + 3);
    }
    const MotionBlock block = ToBlock(moved);
    std::copy(block.begin(), block.end(), x_plus_delta);
    return true;
  }

  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMajorMatrix>(jacobian, 7, TangentSize()).setIdentity();
    return true;
  }

  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Rigid3 to = FromBlock(y), from = FromBlock(x);
    Eigen::Map<Eigen::Vector3d>{y_minus_x} = LogRotation(to.rotation * from.rotation.conjugate());
    if (!turns_only_) {
      Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} = to.translation - from.translation;
    }
    return true;
  }

  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMajorMatrix>(jacobian, TangentSize(), 7).setIdentity();
    return true;
  }

 private:
  bool turns_only_;
};

class ReprojectionCost : public ceres::SizedCostFunction<2, 7, 3, 7> {
 public:
  ReprojectionCost(const StereoRig& rig, const PointObservation& observation)
      : rig_(rig), eye_(observation.eye), pixel_(observation.pixel) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const auto at = Reproject(rig_, eye_, FromBlock(parameters[2]), FromBlock(parameters[0]),
                              Eigen::Map<const Eigen::Vector3d>(parameters[1]));
    if (!at) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = at->pixel - pixel_;
    if (!jacobians) return true;
    using PoseMap = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
    using PointMap = Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>;
    if (jacobians[0]) PoseMap(jacobians[0]) << at->jacobians.pose, Eigen::Vector2d::Zero();
    if (jacobians[1]) PointMap{jacobians[1]} = at->jacobians.point;
    if (jacobians[2]) {
      PoseMap(jacobians[2]) << at->jacobians.rig_rotation, Eigen::Matrix<double, 2, 4>::Zero();
    }
    return true;
  }

 private:
  const StereoRig& rig_;
  Eye eye_;
  Eigen::Vector2d pixel_;
};

class RigPrior : public ceres::SizedCostFunction<3, 7> {
 public:
  RigPrior(const Rigid3& calibrated, double sigma_rad)
      : calibrated_(calibrated), weight_(1.0 / sigma_rad) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Quaterniond turn =
        FromBlock(parameters[0]).rotation * calibrated_.rotation.conjugate();
    Eigen::Map<Eigen::Vector3d>{residuals} = weight_ * LogRotation(turn);
    if (jacobians && jacobians[0]) {
      // Exact for small turns, which is all that the prior allows.
      Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>>{jacobians[0]}
          << weight_ * Eigen::Matrix3d::Identity(),
          Eigen::Matrix<double, 3, 4>::Zero();
    }
    return true;
  }

 private:
  Rigid3 calibrated_;
  double weight_;
};

}  // namespace

MotionBlock ToBlock(const Rigid3& motion) {
  const auto& q = motion.rotation;
  const auto& t = motion.translation;
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

Rigid3 FromBlock(const double* block) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block)),
          Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

std::unique_ptr<ceres::Manifold> MakeFrameManifold() {
  return std::make_unique<MotionManifold>(false);
}

std::unique_ptr<ceres::Manifold> MakeRigManifold() {
  return std::make_unique<MotionManifold>(true);
}

std::unique_ptr<ceres::CostFunction> MakeReprojectionCost(const StereoRig& rig,
                                                          const PointObservation& observation) {
  return std::make_unique<ReprojectionCost>(rig, observation);
}

std::unique_ptr<ceres::CostFunction> MakeRigPrior(const Rigid3& calibrated, double sigma_rad) {
  return std::make_unique<RigPrior>(calibrated, sigma_rad);
}

}  // namespace rigmap
