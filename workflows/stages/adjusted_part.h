// A part whose keyframes a mapping or an adjustment has posed, laid into the world.
#pragma once

#include <string>
#include <vector>

#include "pipeline/stage.h"
#include "scene/adjustment.h"
#include "scene/aligned_keyframes.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/keyframe_graph.h"
#include "scene/odometry.h"
#include "scene/world_up.h"
#include "workflows/stages/posed_part.h"

namespace rigmap {

struct AdjustedPart {
  Adjustment adjustment;  // in its own gauge
  Odometry odometry;      // gives frames that are not adjusted their poses; by the corrected rig
  std::vector<LoopClosure> loop_closures;  // that it started from, likewise
  bool rests_on_mapping = true;            // false: begun from the odometry, whatever was mapped
  Rigid3 world_from_gauge;
  WorldUp world_up = WorldUp::kCamera;
  Trajectory trajectory;             // every paired frame, in the world
  std::vector<std::string> remarks;  // what went otherwise than planned, a sentence each

  // False for poses that came without covariances.
  bool KnowsPositions() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(adjustment, odometry, loop_closures, rests_on_mapping, world_from_gauge, world_up,
            trajectory, remarks);
  }
};

// The gauge of the adjustment laid into the world, and a pose for every frame.
AdjustedPart LayInWorld(const Dataset& dataset, const Odometry& odometry, Adjustment adjustment);

// world_from_left of the frames, of which the aligned keyframes have one.
std::vector<std::optional<Rigid3>> PosesByFrame(const AlignedKeyframes& aligned,
                                                const KeyframeGraph& graph,
                                                std::size_t frame_count);

// What users get of poses and points, whoever found them: trajectories, sparse/ and sparse.ply.
std::vector<std::string> PosesAndPointsOutputs();
void PublishPosesAndPoints(const AdjustedPart& part, const Dataset& dataset,
                           Publication& publication);

// A view.
PosedPart PosedByAdjustment(const StageContext& context, const Dataset& dataset,
                            const AdjustedPart& part);

}  // namespace rigmap
