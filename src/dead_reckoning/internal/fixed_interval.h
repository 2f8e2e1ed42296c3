// A Kalman filter on errors with a fixed-interval smoother behind it (Rauch, Tung and Striebel
// 1965). Poses of earlier frames stay in the state as long as something is measured against them
// (stochastic cloning, Roumeliotis and Burdick 2002).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dead_reckoning/internal/rover_state.h"

namespace rigmap {

struct ClonedPose {
  int frame = 0;
  Rigid3 gauge_from_left;
};

// What is known at a frame. Errors: those of the rover, then six for each clone.
struct Belief {
  RoverState rover;
  std::vector<ClonedPose> clones;
  Eigen::MatrixXd covariance;

  int Size() const { return kStateSize + 6 * static_cast<int>(clones.size()); }
};

Belief Corrected(const Belief& belief, const Eigen::VectorXd& error);
// Of two with the same clones.
Eigen::VectorXd ErrorBetween(const Belief& a, const Belief& b);

// residual = jacobian * error + noise: what was measured less what the belief expects.
struct Measurement {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd noise;  // covariance
};

// Root of the mean square of the residual's numbers, each in its own sigmas.
double InnovationSigmas(const Belief& belief, const Measurement& measurement);
Belief Updated(const Belief& belief, const Measurement& measurement);

// From one frame to the next.
struct Advance {
  Belief predicted;
  Eigen::MatrixXd transition;  // of errors; not square where clones come or go
};
// `kept`: frames whose clones are kept; `frame`, if it is to be cloned itself, is among them.
Advance Advanced(const Belief& belief, int frame, const std::vector<int>& kept,
                 const Prediction& prediction);

// What all measurements together say of each frame. `advances[k]` leads from filtered[k] to k + 1.
std::vector<Belief> Smoothed(const std::vector<Belief>& filtered,
                             const std::vector<Advance>& advances);

}  // namespace rigmap
