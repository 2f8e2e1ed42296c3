#include "registration/internal/cloud_alignment.h"

#include <pcl/common/transforms.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/correspondence_rejection_trimmed.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace rigmap {
namespace {

using Icp = pcl::IterativeClosestPoint<PclPoint, PclPoint>;

Eigen::Matrix4f ToMatrix(const Rigid3& motion) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = motion.rotation.toRotationMatrix().cast<float>();
  matrix.topRightCorner<3, 1>() = motion.translation.cast<float>();
  return matrix;
}

Rigid3 ToRigid(const Eigen::Matrix4f& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>().cast<double>();
  return {Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>().cast<double>()};
}

std::unique_ptr<Icp> Make(const RegistrationOptions& options) {
  switch (options.method) {
    case RegistrationMethod::kPointToPlane: {
      return std::make_unique<pcl::IterativeClosestPointWithNormals<PclPoint, PclPoint>>();
    }
    case RegistrationMethod::kGeneralized: {
      auto icp = std::make_unique<pcl::GeneralizedIterativeClosestPoint<PclPoint, PclPoint>>();
      icp->setTranslationGradientTolerance(1e-4);
      icp->setRotationGradientTolerance(1e-4);
      return icp;
    }
    case RegistrationMethod::kPointToPoint:
      break;
  }
  return std::make_unique<Icp>();
}

void AddRejectors(Icp& icp, const RegistrationOptions& options) {
  if (options.max_normal_angle_deg < 180.0) {
    auto by_normal = std::make_shared<pcl::registration::CorrespondenceRejectorSurfaceNormal>();
    by_normal->setThreshold(std::cos(options.max_normal_angle_deg * std::numbers::pi / 180.0));
    icp.addCorrespondenceRejector(by_normal);
  }
  if (options.kept_share < 1.0) {
    auto trimmed = std::make_shared<pcl::registration::CorrespondenceRejectorTrimmed>();
    trimmed->setOverlapRatio(static_cast<float>(options.kept_share));
    icp.addCorrespondenceRejector(trimmed);
  }
}

// What the planes of the target say of points of the source that lie where they were registered.
void Judge(const PclCloud& source, const PclCloud::Ptr& target, double grid_m,
           CloudAlignment& alignment) {
  constexpr double kClusterGrids = 10.0;
  pcl::search::KdTree<PclPoint> tree;
  tree.setInputCloud(target);
  const double limit_m2 = std::pow(kCounterpartGrids * grid_m, 2);
  Matrix6d information = Matrix6d::Zero();
  std::map<std::array<int, 3>, Vector6d> scores;
  double squares_m2 = 0.0;
  int counterparts = 0;
  pcl::Indices nearest(1);
  std::vector<float> distances_m2(1);
  for (const PclPoint& point : source) {
    const Eigen::Vector3d x = alignment.target_from_source * point.getVector3fMap().cast<double>();
    PclPoint moved;
    moved.getVector3fMap() = x.cast<float>();
    if (tree.nearestKSearch(moved, 1, nearest, distances_m2) < 1) continue;
    if (distances_m2[0] > limit_m2) continue;
    const PclPoint& other = (*target)[nearest[0]];
    const Eigen::Vector3d normal = other.getNormalVector3fMap().cast<double>();
    const double residual_m = normal.dot(x - other.getVector3fMap().cast<double>());
    Vector6d derivative;
    derivative << normal, x.cross(normal);
    information += derivative * derivative.transpose();
    const Eigen::Array3d cluster = (x / (kClusterGrids * grid_m)).array().floor();
    scores.try_emplace({int(cluster[0]), int(cluster[1]), int(cluster[2])}, Vector6d::Zero())
        .first->second += residual_m * derivative;
    squares_m2 += residual_m * residual_m;
    ++counterparts;
  }
  alignment.overlap = counterparts / std::max<double>(1.0, double(source.size()));
  alignment.rms_m = std::sqrt(squares_m2 / std::max(1, counterparts));
  Matrix6d scatter = Matrix6d::Zero();
  for (const auto& [cluster, score] : scores) scatter += score * score.transpose();
  const Matrix6d inverse = information.inverse();
  alignment.covariance = inverse * scatter * inverse;
  if (!alignment.covariance.allFinite()) alignment.converged = false;
}

}  // namespace

CloudAlignment Align(const PclCloud::Ptr& source, const PclCloud::Ptr& target,
                     const Rigid3& guessed_target_from_source, double grid_m,
                     const RegistrationOptions& options) {
  constexpr double kTolerance_m = 1e-4, kTolerance_rad = 1e-5;
  const auto icp = Make(options);
  icp->setInputSource(source);
  icp->setInputTarget(target);
  icp->setMaximumIterations(options.max_iterations);
  icp->setTransformationEpsilon(kTolerance_m * kTolerance_m);
  icp->setTransformationRotationEpsilon(std::cos(kTolerance_rad));
  if (options.max_correspondence_grids > 0.0) {
    icp->setMaxCorrespondenceDistance(options.max_correspondence_grids * grid_m);
  }
  AddRejectors(*icp, options);
  PclCloud moved;
  icp->align(moved, ToMatrix(guessed_target_from_source));
  CloudAlignment alignment{.target_from_source = ToRigid(icp->getFinalTransformation()),
                           .converged = icp->hasConverged()};
  Judge(*source, target, grid_m, alignment);
  return alignment;
}

}  // namespace rigmap
