// From placed keyframes to the part's trajectory: which poses the adjustment starts from, and what
// is done when it fails.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/adjustment.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/odometry.h"
#include "scene/trajectory.h"
#include "scene/world_up.h"
#include "workflows/part_options.h"

namespace rigmap {

struct AdjustedPart {
  Adjustment adjustment;  // in its own gauge
  Odometry odometry;      // which frames that are not adjusted hang on; of the rig as corrected
  Rigid3 world_from_gauge;
  WorldUp world_up = WorldUp::kCamera;
  Trajectory trajectory;             // every paired frame, in the world
  std::vector<std::string> remarks;  // what went otherwise than planned, a sentence each

  template <class Archive>
  void serialize(Archive& archive) {
    archive(adjustment, odometry, world_from_gauge, world_up, trajectory, remarks);
  }
};

struct PartToAdjust {
  const Dataset& dataset;
  const Correspondences& matches;
  const Odometry& odometry;
  std::vector<std::optional<Rigid3>> mapped;  // world_from_left of the frames that COLMAP posed
  std::function<FrameFeatures(int frame)> features;
  const PartOptions& options;
};

// Adjusts from the mapped poses. Where the rig had to be corrected, the odometry is done anew with
// the corrected rig and the adjustment starts from it, since steps that only the odometry knows
// were measured with the wrong rig. Where a gate on an adjustment fails that started from mapped
// poses, it starts from the odometry alone, which is kept if it passes.
AdjustedPart AdjustPart(const PartToAdjust& part);

}  // namespace rigmap
