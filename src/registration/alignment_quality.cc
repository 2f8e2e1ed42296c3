#include "registration/internal/alignment_quality.h"

#include <pcl/search/kdtree.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace rigmap {
namespace {

// A point of the source, where it was registered, and the nearest of the target.
struct Counterpart {
  Eigen::Vector3d x = Eigen::Vector3d::Zero(), other = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), other_normal = Eigen::Vector3d::Zero();
  double weight = 0.0;
  float distance_m2 = 0.0F;
};

std::vector<Counterpart> CounterpartsOf(const PclCloud& source, const PclCloud::Ptr& target,
                                        double grid_m, const Rigid3& target_from_source) {
  pcl::search::KdTree<PclPoint> tree;
  tree.setInputCloud(target);
  const double limit_m2 = std::pow(kCounterpartGrids * grid_m, 2);
  const Eigen::Vector3f camera = target_from_source.translation.cast<float>();
  std::vector<Counterpart> counterparts;
  pcl::Indices nearest(1);
  std::vector<float> distances_m2(1);
  for (const PclPoint& point : source) {
    Counterpart pair{.x = target_from_source * point.getVector3fMap().cast<double>()};
    PclPoint moved;
    moved.getVector3fMap() = pair.x.cast<float>();
    if (tree.nearestKSearch(moved, 1, nearest, distances_m2) < 1) continue;
    if (distances_m2[0] > limit_m2) continue;
    const PclPoint& other = (*target)[nearest[0]];
    pair.other = other.getVector3fMap().cast<double>();
    pair.other_normal = other.getNormalVector3fMap().cast<double>();
    pair.normal = target_from_source.rotation * point.getNormalVector3fMap().cast<double>();
    pair.weight = WeightOf(point, other, camera, grid_m);
    pair.distance_m2 = distances_m2[0];
    counterparts.push_back(pair);
  }
  return counterparts;
}

// As those that AddRejectors gives to PCL.
void Reject(const RegistrationOptions& options, std::vector<Counterpart>& pairs) {
  const double least_cosine = std::cos(options.max_normal_angle_deg * std::numbers::pi / 180.0);
  std::erase_if(pairs, [&](const Counterpart& pair) {
    return pair.normal.dot(pair.other_normal) < least_cosine;
  });
  const auto kept =
      static_cast<std::ptrdiff_t>(options.kept_share * static_cast<double>(pairs.size()));
  std::ranges::nth_element(pairs, pairs.begin() + kept, {}, &Counterpart::distance_m2);
  pairs.resize(static_cast<std::size_t>(kept));
}

// Of the distance of x from a plane with this normal, by a left perturbation of what moved x.
Vector6d DistanceDerivative(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
  Vector6d derivative;
  derivative << normal, x.cross(normal);
  return derivative;
}

// Sums of the normal equations, weighted.
struct PlaneEquations {
  static constexpr double kClusterGrids = 10.0;

  Matrix6d information = Matrix6d::Zero();
  Vector6d farther = Vector6d::Zero();  // of the score, if points were farther (CloudAlignment)
  std::map<std::array<int, 3>, Vector6d> scores;  // by cubes of kClusterGrids boxes
  double squares_m2 = 0.0;

  void Add(const Counterpart& pair, const Rigid3& target_from_source, double grid_m) {
    const double residual_m = pair.other_normal.dot(pair.x - pair.other);
    const Vector6d by_target = DistanceDerivative(pair.x, pair.other_normal);
    const Vector6d by_source = DistanceDerivative(pair.x, pair.normal);
    information +=
        0.5 * pair.weight * (by_target * by_source.transpose() + by_source * by_target.transpose());
    const Eigen::Array3i cube = (pair.x / (kClusterGrids * grid_m)).array().floor().cast<int>();
    scores.try_emplace({cube[0], cube[1], cube[2]}, Vector6d::Zero()).first->second +=
        pair.weight * residual_m * by_target;
    squares_m2 += residual_m * residual_m;
    const Eigen::Vector3d ray = pair.x - target_from_source.translation;
    const double depth_m = (target_from_source.rotation.inverse() * ray).z();
    farther += pair.weight * pair.other_normal.dot(depth_m * ray - pair.other.z() * pair.other) *
               by_target;
  }

  Matrix6d Scatter() const {
    Matrix6d scatter = Matrix6d::Zero();
    for (const auto& [cube, score] : scores) scatter += score * score.transpose();
    return scatter;
  }
};

}  // namespace

float WeightOf(const PclPoint& source, const PclPoint& target, const Eigen::Vector3f& camera,
               double grid_m) {
  constexpr float kLeastShare = 0.1F;  // of a box: by so much surfaces are no planes
  const Eigen::Vector3f ray = (target.getVector3fMap() - camera).normalized();
  const float off_m = std::abs(ray.dot(target.getNormalVector3fMap())) *
                      std::hypot(target.curvature, source.curvature);
  const float least_m = kLeastShare * static_cast<float>(grid_m);
  return 1.0F / (off_m * off_m + least_m * least_m);
}

void Judge(const PclCloud& source, const PclCloud::Ptr& target, double grid_m,
           const RegistrationOptions& options, CloudAlignment& alignment) {
  auto pairs = CounterpartsOf(source, target, grid_m, alignment.target_from_source);
  alignment.overlap =
      static_cast<double>(pairs.size()) / std::max(1.0, static_cast<double>(source.size()));
  Reject(options, pairs);
  PlaneEquations equations;
  const Rigid3& found = alignment.target_from_source;
  for (const Counterpart& pair : pairs) equations.Add(pair, found, grid_m);
  alignment.rms_m =
      std::sqrt(equations.squares_m2 / std::max(1.0, static_cast<double>(pairs.size())));
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(equations.information);
  alignment.held = eigen.eigenvalues()[0] > 0.0;
  if (!alignment.held) return;
  const Matrix6d inverse = equations.information.inverse();
  alignment.covariance = inverse * equations.Scatter() * inverse;
  const double length_m = found.translation.norm();
  if (length_m > 0.0) {
    const Vector6d following = -inverse * equations.farther;
    alignment.lengthening_m = found.translation.dot(following.head<3>()) / length_m;
  }
}

}  // namespace rigmap
