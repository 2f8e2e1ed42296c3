// The slope of a plane whose gradient is uncertain.
#pragma once

#include <Eigen/Core>

namespace rigmap {

// The probability that a gradient (metres up per metre along x and along y), normally distributed
// about `gradient` with `covariance`, is longer than tan(limit_rad): the mass of the normal
// distribution outside a circle, by quadrature to 1e-4 (1e-7 where its sigmas are alike). The
// covariance may be singular, even zero.
double ProbabilityOfSteeper(const Eigen::Vector2d& gradient, const Eigen::Matrix2d& covariance,
                            double limit_rad);

}  // namespace rigmap
