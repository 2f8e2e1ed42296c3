// The stages `dead_reckoning` and `filter`: the poses of a part by the rover's own sensors, without
// and with visual motion.
#pragma once

#include "dead_reckoning/dead_reckoning_options.h"
#include "pipeline/stage.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {

struct DeadReckonedPart {
  OdometricPart part;
  // What was estimated beside the poses (dead_reckoning/estimate_motion.h).
  double wheel_scale = 1.0, wheel_scale_sigma = 0.0;
  Eigen::Vector3d gyro_bias_radps = Eigen::Vector3d::Zero();
  std::vector<int> slips, misled;
  double visual_scale_sigma = 0.0;  // of all distances together; contained in the sigmas

  template <class Archive>
  void serialize(Archive& archive) {
    archive(part, wheel_scale, wheel_scale_sigma, gyro_bias_radps, slips, misled,
            visual_scale_sigma);
  }
};

using DeadReckoningStage = Stage<DeadReckonedPart, Takes<Dataset>, Reads<DeadReckoningOptions>>;
DeadReckoningStage DeadReckoning();

using FilterStage =
    Stage<DeadReckonedPart, Takes<Dataset, FeatureStore, Odometry>,
          Reads<DeadReckoningOptions, FilterOptions, OdometryOptions, AdjustmentOptions>>;
FilterStage Filter();

// How much of what the images told the filter refused, because wheels and gyro tell of another
// motion: where that is more than a little, one of them is wrong throughout.
using FilterGatesCheck = Check<Takes<DeadReckonedPart, Odometry>, Reads<>>;
FilterGatesCheck FilterGates();

// Views: as the techniques without an adjustment have a part, and its steps for the gates.
OdometricPart PartOfRover(const StageContext& context, const DeadReckonedPart& rover);
// For the map: what stretches it as a whole blurs nothing, and is not in the sigmas.
PosedPart PosedByRover(const StageContext& context, const Dataset& dataset,
                       const DeadReckonedPart& rover);
Odometry StepsOfRover(const StageContext& context, const DeadReckonedPart& rover);

}  // namespace rigmap
