#include "registration/internal/cloud_alignment.h"

#include <pcl/common/transforms.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/correspondence_rejection_trimmed.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls_weighted.h>

#include <Eigen/Eigenvalues>
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
      auto icp = std::make_unique<pcl::IterativeClosestPointWithNormals<PclPoint, PclPoint>>();
      icp->setTransformationEstimation(
          std::make_shared<pcl::registration::TransformationEstimationPointToPlaneLLSWeighted<
              PclPoint, PclPoint>>());
      return icp;
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

// Weight of a pair's distance off the plane of its target, whose cloud and the source's were seen
// from about `camera`: both points are known by their sigmas along rays, of which a plane seen edge
// on shows little.
float WeightOf(const PclPoint& source, const PclPoint& target, const Eigen::Vector3f& camera,
               double grid_m) {
  constexpr float kLeastShare = 0.1F;  // of a box: by so much surfaces are no planes
  const Eigen::Vector3f ray = (target.getVector3fMap() - camera).normalized();
  const float off_m = std::abs(ray.dot(target.getNormalVector3fMap())) *
                      std::hypot(target.curvature, source.curvature);
  const float least_m = kLeastShare * static_cast<float>(grid_m);
  return 1.0F / (off_m * off_m + least_m * least_m);
}

// Rejects nothing: gives the pairs their weights, which PCL's weighted estimation reads.
class WeighPairs : public pcl::registration::CorrespondenceRejector {
 public:
  WeighPairs(PclCloud::ConstPtr source, PclCloud::ConstPtr target, const Eigen::Vector3f& camera,
             double grid_m)
      : source_(std::move(source)), target_(std::move(target)), camera_(camera), grid_m_(grid_m) {
    rejection_name_ = "WeighPairs";
  }

  void getRemainingCorrespondences(const pcl::Correspondences& given,
                                   pcl::Correspondences& remaining) override {
    remaining = given;
    for (pcl::Correspondence& pair : remaining) {
      pair.weight =
          WeightOf((*source_)[pair.index_query], (*target_)[pair.index_match], camera_, grid_m_);
    }
  }

 protected:
  void applyRejection(pcl::Correspondences& correspondences) override {
    getRemainingCorrespondences(*input_correspondences_, correspondences);
  }

 private:
  PclCloud::ConstPtr source_, target_;
  Eigen::Vector3f camera_;
  double grid_m_;
};

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

// Of the distance of x from a plane with this normal, by a left perturbation of what moved x.
Vector6d DistanceDerivative(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
  Vector6d derivative;
  derivative << normal, x.cross(normal);
  return derivative;
}

// What the planes of the target say of points of the source that lie where they were registered.
void Judge(const PclCloud& source, const PclCloud::Ptr& target, double grid_m,
           CloudAlignment& alignment) {
  constexpr double kClusterGrids = 10.0;
  pcl::search::KdTree<PclPoint> tree;
  tree.setInputCloud(target);
  const double limit_m2 = std::pow(kCounterpartGrids * grid_m, 2);
  const Eigen::Vector3f camera = alignment.target_from_source.translation.cast<float>();
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
    const Vector6d derivative = DistanceDerivative(x, normal);
    const Vector6d by_source = DistanceDerivative(
        x, alignment.target_from_source.rotation * point.getNormalVector3fMap().cast<double>());
    const double weight = WeightOf(point, other, camera, grid_m);
    information +=
        0.5 * weight * (derivative * by_source.transpose() + by_source * derivative.transpose());
    const Eigen::Array3d cluster = (x / (kClusterGrids * grid_m)).array().floor();
    scores.try_emplace({int(cluster[0]), int(cluster[1]), int(cluster[2])}, Vector6d::Zero())
        .first->second += weight * residual_m * derivative;
    squares_m2 += residual_m * residual_m;
    ++counterparts;
  }
  alignment.overlap = counterparts / std::max<double>(1.0, double(source.size()));
  alignment.rms_m = std::sqrt(squares_m2 / std::max(1, counterparts));
  Matrix6d scatter = Matrix6d::Zero();
  for (const auto& [cluster, score] : scores) scatter += score * score.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  alignment.held = eigen.eigenvalues()[0] > 0.0;
  if (!alignment.held) return;
  const Matrix6d inverse = information.inverse();
  alignment.covariance = inverse * scatter * inverse;
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
  const Eigen::Vector3f camera = guessed_target_from_source.translation.cast<float>();
  if (options.method == RegistrationMethod::kPointToPlane) {
    icp->addCorrespondenceRejector(std::make_shared<WeighPairs>(source, target, camera, grid_m));
  }
  PclCloud moved;
  icp->align(moved, ToMatrix(guessed_target_from_source));
  CloudAlignment alignment{.target_from_source = ToRigid(icp->getFinalTransformation()),
                           .converged = icp->hasConverged()};
  Judge(*source, target, grid_m, alignment);
  return alignment;
}

}  // namespace rigmap
