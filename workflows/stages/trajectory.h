// The stage `trajectory`: the poses of the odometry as the result, where a technique adjusts none.
#pragma once

#include <string>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "features/feature_store.h"
#include "odometry/odometry_options.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"
#include "scene/odometry.h"
#include "scene/world_up.h"
#include "workflows/stages/posed_part.h"

namespace rigmap {

struct OdometricPart {
  StereoRig rig;
  Trajectory trajectory;        // every paired frame, in the world
  PointsInLeft points_in_left;  // of its keyframes; empty where no images were asked
  WorldUp world_up = WorldUp::kCamera;
  // Of all lengths, by what the calibration may be off; and the offset of all disparities that
  // residuals ask for, px, which was not corrected (adjustment/unchecked_scale.h).
  double calibration_scale_sigma = 0.0, asked_offset_px = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rig, trajectory, points_in_left, world_up, calibration_scale_sigma, asked_offset_px);
  }
};

using TrajectoryStage = Stage<OdometricPart, Takes<Dataset, FeatureStore, Odometry>,
                              Reads<OdometryOptions, AdjustmentOptions>>;
TrajectoryStage OdometricTrajectory();

// What the keyframes see with both eyes.
PointsInLeft PointsOfKeyframes(const StereoRig& rig, const FeatureStore& features,
                               const Odometry& odometry, double disparity_noise_px);

// A view.
PosedPart PosedByOdometry(const StageContext& context, const Dataset& dataset,
                          const OdometricPart& part);

// What summary.json says of any trajectory.
Report ReportTrajectory(const Trajectory& trajectory, WorldUp world_up);

}  // namespace rigmap
