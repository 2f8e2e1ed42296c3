// The synthetic rover as the stage `database` gets it.
#pragma once

#include "mapping/build_graph.h"
#include "mapping/seed_model.h"
#include "tests/support/rover_correspondences.h"

namespace rigmap {

struct RoverPart {
  SyntheticRover rover;
  Correspondences correspondences;
  Odometry odometry;
  Dataset dataset;

  KeyframeGraph Graph(const KeyframeGraphOptions& options = {}) const {
    return BuildKeyframeGraph(correspondences, odometry, dataset, options);
  }
};

// Every frame a keyframe, on its true pose; matches up to four frames apart.
RoverPart MakeRoverPart(const SyntheticRoverOptions& options);

// Takes away all matches between frames before `frame` and from it on.
void CutBefore(int frame, Correspondences& correspondences);

// world_from_left of the graph's keyframes, as the odometry has it.
std::vector<Rigid3> KeyframePoses(const KeyframeGraph& graph, const Odometry& odometry);

}  // namespace rigmap
