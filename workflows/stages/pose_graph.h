// The stage `pose_graph`: leaves posegraph.g2o and posegraph.json.
#pragma once

#include <string>

#include "pipeline/stage.h"
#include "workflows/stages/adjusted_part.h"

namespace rigmap {

// What is published of it follows from what it takes.
struct PoseGraphText {
  std::string g2o, json;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(g2o, json);
  }
};

using PoseGraphStage = Stage<PoseGraphText, Takes<AdjustedPart>, Reads<>>;
// Adjusted poses in the world, and between them the steps that the odometry measured and the loop
// closures, each with its information.
PoseGraphStage PartPoseGraph();

}  // namespace rigmap
