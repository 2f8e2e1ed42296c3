// The motion of a stereo rig from points known in one frame and seen in another.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/offset_effect.h"
#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

// A point known in the reference frame's left camera, with the sigma of its depth, and where the
// moved rig sees it. Normalised (undistorted) coordinates of the left and, if there, right eye.
struct PointSighting {
  Eigen::Vector3d x_in_reference;  // metres
  double depth_sigma_m = 0.0;      // along the reference's line of sight
  Eigen::Vector2d left;
  std::optional<Eigen::Vector2d> right;
};

struct StereoPoseOptions {
  double noise_px = 0.3;  // of a sighting, one standard deviation per axis
  // Likewise of the reference's own keypoint across the line of sight: both eyes' sightings of a
  // point are off by it together. None where sightings are measured from the reference's patch.
  double reference_noise_px = 0.0;
  double max_sigmas = 4.0;  // an inlier lies within so many, noise and depth sigma together
  int min_inliers = 15;     // below, a wrong motion may fit as well by chance
  int max_samples = 200;    // of three points, for the random search
};

struct StereoPose {
  Rigid3 current_from_reference;
  Matrix6d covariance = Matrix6d::Zero();  // of a left perturbation (translation m, rotation rad)
  std::vector<bool> inliers;               // counted on this very pose, one per sighting
  int inlier_count = 0;
  // Of the motion's length, as a share of it and beyond the covariance. A disparity that is off by
  // its noise in all points alike, by the calibration, falsifies a motion by as much as their
  // depths; of points that are far this is more than all else. Zero where some points are near.
  double metres_sigma = 0.0;
  OffsetEffect offset;
};

// RANSAC over three-point poses and the given guesses, then a robust least-squares refinement in
// which every sighting is weighted by pixel noise and by the depth sigma of its point. The random
// search is seeded by the data: equal input gives equal output. Points whose depth is not known to
// a third tell a turn alone. Nothing if too few points agree, or if most of these are so far and
// hardly any near: hills look the same from wherever they are seen.
std::optional<StereoPose> EstimateStereoPose(std::span<const PointSighting> sightings,
                                             const StereoRig& rig, std::span<const Rigid3> guesses,
                                             const StereoPoseOptions& options);

}  // namespace rigmap
