// The poses that agree best with all edges of a pose graph.
#pragma once

#include "scene/pose_graph.h"

namespace rigmap {

struct PoseGraphOptions {
  // Loop closures may be wrong: they pull under Cauchy's loss at so many sigmas, all other edges
  // by their squares. At 2, a closure cannot pull further than four sigmas of the steps in between.
  double closure_cauchy_sigmas = 2.0;
  int max_iterations = 200;
};

// The graph with its nodes moved to the least sum of the edges' errors, the first node of every
// group that edges hold together held (Ceres, sparse, one thread: equal input gives equal output).
// Twice the vector part of an error's quaternion stands for its rotation vector, which it is for
// all but gross errors. Covariances of moved nodes are dropped: they were another solution's.
PoseGraph OptimisePoseGraph(const PoseGraph& graph, const PoseGraphOptions& options = {});

// Length of an edge's weighted error at the graph's poses: in sigmas, of six coordinates together.
double ErrorSigmas(const PoseEdge& edge, const PoseGraph& graph);

}  // namespace rigmap
