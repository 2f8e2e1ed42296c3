// A part adjusted from the poses of its mapping or of its odometry, with the rig that its images
// ask for.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "features/feature_store.h"
#include "matching/matching_options.h"
#include "scene/adjustment.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/odometry.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/odometry.h"

namespace rigmap {

class PartAdjuster {
 public:
  struct Input {
    const Dataset& dataset;
    const FeatureStore& features;
    const Odometry& odometry;
    const Correspondences& matches;
  };
  struct Options {
    const MatchingOptions& matching;
    const AdjustmentOptions& adjustment;
    BridgingOptions bridging;
  };
  using Poses = std::vector<std::optional<Rigid3>>;  // world_from_left

  PartAdjuster(const Input& input, const Options& options) : input_(input), options_(options) {}

  // From the odometry, and from `mapped` where that has poses. Where the images correct the rig,
  // the odometry is done anew and loop closures are measured anew with the corrected one, and all
  // starts from that, since both erred as the wrong rig did. The odometry is done once more by what
  // the adjustment has found beside the rig, if there is such a thing.
  AdjustedPart From(const Poses& mapped) const;

 private:
  // As one rig measures them.
  struct Motions {
    Odometry steps;
    std::vector<LoopClosure> loop_closures;
  };
  // Adjusted from these poses, which carry each side of the frames `apart` along.
  struct Sides {
    Poses starting;
    std::vector<int> apart;
    Adjustment adjustment;
  };

  AdjustedPart WithItsRig(AdjustedPart part) const;
  // A corrected rig is provisional but where it starts from that of an adjustment before.
  AdjustedPart From(const Poses& mapped, const Correspondences& correspondences, Motions motions,
                    const Adjustment* before) const;
  AdjustedPart WithStepsAsModelled(AdjustedPart part) const;
  // With its rig, and these features.
  Odometry StepsWith(const AdjustedPart& part, const FeatureSource& features) const;

  Input input_;
  Options options_;
};

}  // namespace rigmap
