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
  CalibrationVector correction = CalibrationVector::Zero();  // of the rig, to start from
};

struct Adjustment {
  std::vector<std::optional<Rigid3>> world_from_left;  // in the gauge of the input
  std::vector<int> anchors;                            // CameraSystemResult's, inflated
  std::vector<Matrix6d> covariances;                   // CameraSystemResult's, inflated
  std::vector<int> observation_counts;                 // per frame, after the last cull
  std::vector<AdjustedPoint> points;
  StereoRig rig;  // as calibrated, unless the part corrected it
  // By how much it was corrected, also in sigmas of the prior; zero if it was not.
  CalibrationVector rig_correction = CalibrationVector::Zero();
  CalibrationVector rig_correction_sigmas = CalibrationVector::Zero();
  double noise_px = 0.0;         // robust sigma of one residual coordinate
  double reprojection_px = 0.0;  // median distance
  double outlier_share = 0.0;    // of all observations of tracks in the posed frames
  // Nothing on a path shorter than the baseline, which adds nothing to what one frame tells of the
  // rig, however many frames repeat it.
  std::optional<CalibrationEquations> calibration;

  bool IsRigCorrected() const { return !rig_correction_sigmas.isZero(); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(world_from_left, anchors, covariances, observation_counts, points, rig, rig_correction,
            rig_correction_sigmas, noise_px, reprojection_px, outlier_share, calibration);
  }
};

// In rounds: triangulates all tracks on the poses as they stand, adjusts poses and points together
// and drops outliers (Ceres, sparse Schur, robust loss, one thread: equal input gives equal
// output). Frames with too few observations (10) keep no pose.
Adjustment AdjustBundle(const AdjustmentInput& input, const AdjustmentOptions& options);

}  // namespace rigmap
