// Points of a plane laid on measured ones by a rotation and a translation.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rigmap {

// A rigid motion of the plane: turned by angle_rad counterclockwise, then moved.
struct Rigid2 {
  double angle_rad = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& x) const;
  Rigid2 Inverse() const;
};

struct PlanePair {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();     // of `to`, each axis, positive
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // of `from`, per second
};

// Distance of to from to_from_from * from, in sigmas.
double NormalisedDistance(const Rigid2& to_from_from, const PlanePair& pair);

// Minimises a sum of distances rather than of squares, so that a minority of outliers hardly
// matters (iteratively reweighted least squares). Each pair counts with the mean sigma of its axes.
// At least one pair; where all `from` coincide the angle is 0.
Rigid2 FitRobustly(std::span<const PlanePair> pairs);

}  // namespace rigmap
