#include "workflows/stages/odometric_adjustment.h"

#include "pipeline/code_identity.h"
#include "workflows/stages/part_adjuster.h"

namespace rigmap {
namespace {

AdjustedPart MakeFromOdometry(const StageContext&, const Dataset& dataset,
                              const FeatureStore& features, const Odometry& odometry,
                              const Correspondences& matches, const FeatureOptions& of_features,
                              const CornerOptions& corners, const MaskOptions& masks,
                              const MatchingOptions& matching, const AdjustmentOptions& options,
                              const OdometryOptions& odometry_options,
                              const DeadReckoningOptions& rover, const FilterOptions& filter) {
  const BridgingOptions bridging{of_features, corners, masks, odometry_options, rover, filter};
  return PartAdjuster({dataset, features, odometry, matches}, {matching, options, bridging})
      .From({});
}

}  // namespace

OdometricAdjustmentStage OdometricAdjustment() {
  return {
      .name = "odometric_adjustment",
      .about =
          "one pose per frame from the odometry, while COLMAP maps; the rig held and, where the "
          "images contradict it, corrected between rounds, the odometry and the matches anew "
          "with it",
      .code = CodeHere(),
      .make = MakeFromOdometry};
}

}  // namespace rigmap
