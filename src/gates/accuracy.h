// How good the poses of a part are, by what they say of themselves.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "scene/adjustment.h"
#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

// At 95 %, relative to the first posed frame, the baseline's own sigma counted where the rig states
// it. No scale for a rig that stands, whose path is shorter than its baseline; nothing at all where
// fewer than two frames are measured.
struct Accuracy {
  double path_m = 0.0;
  std::optional<double> scale_95_pct;  // half of the interval that holds the true scale
  // What it would be by noise alone (nothing where the adjustment does not say), and by the sigma
  // that the rig file states of its baseline alone (nothing where it states none).
  std::optional<double> noise_95_pct, baseline_95_pct;
  std::optional<double> position_95_m;    // radius about the worst measured position
  std::optional<double> position_95_pct;  // of the path, or of a metre if that is longer
};

// What a trajectory's covariances leave out.
struct BesideCovariances {
  // False where nobody has said how good the poses are, as of those that only COLMAP adjusted: then
  // the scale is the adjustment's or nothing.
  bool positions_known = true;
  // Relative, of all lengths. Infinite where no length is known: so are the figures then.
  double calibration_scale_sigma = 0.0;
  // Relative, of all lengths: by how much the metres of one ring of the image contradict those of
  // another (DepthConsistency). Whichever is right, no length is known better.
  double depth_contradiction = 0.0;
};

// The scale is the adjustment's where it knows one, else the less sure of two: that of the way to
// the farthest measured frame, and that of a similarity alignment, if errors add up along the way.
// Predicted frames are left out.
Accuracy AccuracyOf(const Trajectory& trajectory, const Adjustment& adjustment,
                    const StereoRig& rig, const BesideCovariances& beside = {});

// True for the gates that ask how good a result is, not whether it contradicts itself.
bool IsAboutAccuracy(const std::string& gate);

// Radius of the sphere that holds a normally distributed error with 95 %, to 2 % (the weighted sum
// of squares taken as a scaled chi square, Satterthwaite 1946; its quantile by Wilson and Hilferty
// 1931). Infinite for what is not finite.
double Radius95(const Eigen::Matrix3d& covariance);

}  // namespace rigmap
