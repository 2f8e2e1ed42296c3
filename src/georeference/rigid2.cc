#include "georeference/rigid2.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr int kIterations = 30;

// The weighted least-squares motion in closed form.
Rigid2 Fit(std::span<const PlanePair> pairs, const std::vector<double>& weights) {
  Eigen::Vector2d from_mean = Eigen::Vector2d::Zero(), to_mean = Eigen::Vector2d::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from_mean += weights[i] * pairs[i].from;
    to_mean += weights[i] * pairs[i].to;
    sum += weights[i];
  }
  from_mean /= sum;
  to_mean /= sum;
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector2d from = pairs[i].from - from_mean, to = pairs[i].to - to_mean;
    dot += weights[i] * from.dot(to);
    cross += weights[i] * (from.x() * to.y() - from.y() * to.x());
  }
  Rigid2 motion{.angle_rad = std::atan2(cross, dot)};
  motion.translation = to_mean - motion * from_mean;
  return motion;
}

}  // namespace

Eigen::Vector2d Rigid2::operator*(const Eigen::Vector2d& x) const {
  return Eigen::Rotation2Dd(angle_rad) * x + translation;
}

Rigid2 Rigid2::Inverse() const {
  return {-angle_rad, -(Eigen::Rotation2Dd(-angle_rad) * translation)};
}

double NormalisedDistance(const Rigid2& to_from_from, const PlanePair& pair) {
  return (to_from_from * pair.from - pair.to).cwiseQuotient(pair.sigma).norm();
}

Rigid2 FitRobustly(std::span<const PlanePair> pairs) {
  std::vector<double> weights(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    weights[i] = 1.0 / pairs[i].sigma.squaredNorm();
  }
  Rigid2 motion = Fit(pairs, weights);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double distance = std::max(1.0, NormalisedDistance(motion, pairs[i]));
      weights[i] = 1.0 / (pairs[i].sigma.squaredNorm() * distance);
    }
    motion = Fit(pairs, weights);
  }
  return motion;
}

}  // namespace rigmap
