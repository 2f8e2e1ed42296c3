#include "adjustment/internal/reprojection_cost.h"

#include <ceres/sized_cost_function.h>

#include <algorithm>

#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

class FrameManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Rigid3 motion = FromBlock(x);
    const Eigen::Quaterniond turn = ExpRotation(Eigen::Map<const Eigen::Vector3d>(delta));
    const MotionBlock block =
        ToBlock({(turn * motion.rotation).normalized(),
                 motion.translation + Eigen::Map<const Eigen::Vector3d>(delta + 3)});
    std::copy(block.begin(), block.end(), x_plus_delta);
    return true;
  }

  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }

  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Rigid3 to = FromBlock(y), from = FromBlock(x);
    Eigen::Map<Eigen::Vector3d>{y_minus_x} = LogRotation(to.rotation * from.rotation.conjugate());
    Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} = to.translation - from.translation;
    return true;
  }

  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

class ReprojectionCost : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  ReprojectionCost(const StereoRig& rig, const PointObservation& observation)
      : rig_(rig), eye_(observation.eye), pixel_(observation.pixel) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const auto at = Reproject(rig_, eye_, FromBlock(parameters[0]),
                              Eigen::Map<const Eigen::Vector3d>(parameters[1]));
    if (!at) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = at->pixel - pixel_;
    if (!jacobians) return true;
    using PoseMap = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
    using PointMap = Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>;
    if (jacobians[0]) PoseMap(jacobians[0]) << at->jacobians.pose, Eigen::Vector2d::Zero();
    if (jacobians[1]) PointMap{jacobians[1]} = at->jacobians.point;
    return true;
  }

 private:
  const StereoRig& rig_;
  Eye eye_;
  Eigen::Vector2d pixel_;
};

}  // namespace

std::unique_ptr<ceres::Manifold> MakeFrameManifold() { return std::make_unique<FrameManifold>(); }

std::unique_ptr<ceres::CostFunction> MakeReprojectionCost(const StereoRig& rig,
                                                          const PointObservation& observation) {
  return std::make_unique<ReprojectionCost>(rig, observation);
}

}  // namespace rigmap
