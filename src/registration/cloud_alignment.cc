#include "registration/internal/cloud_alignment.h"

#include <pcl/common/transforms.h>
#include <pcl/registration/correspondence_rejection_surface_normal.h>
#include <pcl/registration/correspondence_rejection_trimmed.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/transformation_estimation_point_to_plane_lls_weighted.h>

#include <cmath>
#include <numbers>

#include "registration/internal/alignment_quality.h"

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

}  // namespace

CloudAlignment Align(const PclCloud::Ptr& source, const PclCloud::Ptr& target,
                     const Rigid3& guessed_target_from_source, double grid_m,
                     const RegistrationOptions& options) {
  constexpr double kTolerance_m = 1e-4, kTolerance_rad = 1e-3;
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
  Judge(*source, target, grid_m, options, alignment);
  return alignment;
}

}  // namespace rigmap
