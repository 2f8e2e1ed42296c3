// The stage `adjustment`: bundle adjustment with one pose per frame and the rig held at its
// calibration.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjusted_points.h"
#include "adjustment/adjustment_options.h"
#include "adjustment/camera_system.h"
#include "scene/trajectory.h"

namespace rigmap {

struct AdjustmentInput {
  const Correspondences& correspondences;
  const StereoRig& rig;
  // Metric starting poses; a frame without one is not adjusted. The first that has one is held, and
  // so is the first of every further group of frames that shares no points with those before.
  std::vector<std::optional<Rigid3>> world_from_left;
};

struct Adjustment {
  std::vector<std::optional<Rigid3>> world_from_left;  // in the gauge of the input
  std::vector<int> anchors;                            // CameraSystemResult's, inflated
  std::vector<Matrix6d> covariances;                   // CameraSystemResult's, inflated
  std::vector<int> observation_counts;                 // per frame, after the last cull
  std::vector<AdjustedPoint> points;
  Rigid3 right_from_left;        // as calibrated, unless refined
  double noise_px = 0.0;         // robust sigma of one residual coordinate
  double reprojection_px = 0.0;  // median distance
  double outlier_share = 0.0;    // of all observations of tracks in the posed frames
  std::optional<CalibrationStep> calibration;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(world_from_left, anchors, covariances, observation_counts, points, right_from_left,
            noise_px, reprojection_px, outlier_share, calibration);
  }
};

// In rounds: triangulates all tracks on the poses as they stand, adjusts poses and points together
// and drops outliers (Ceres, sparse Schur, robust loss, one thread: equal input gives equal
// output). Frames with too few observations (10) keep no pose.
Adjustment AdjustBundle(const AdjustmentInput& input, const AdjustmentOptions& options);

}  // namespace rigmap
