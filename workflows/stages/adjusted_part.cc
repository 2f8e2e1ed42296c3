#include "workflows/stages/adjusted_part.h"

#include <algorithm>

#include "adjustment/level_world.h"
#include "trajectory/assemble_trajectory.h"
#include "trajectory/starting_poses.h"
#include "workflows/stages/sparse_output.h"
#include "workflows/stages/trajectory_output.h"

namespace rigmap {

bool AdjustedPart::KnowsPositions() const {
  return !adjustment.covariances.empty() ||
         std::ranges::none_of(adjustment.world_from_left,
                              [](const auto& pose) { return pose.has_value(); });
}

AdjustedPart LayInWorld(const Dataset& dataset, const Odometry& odometry, Adjustment adjustment) {
  std::vector<Eigen::Vector3d> points;
  for (const AdjustedPoint& point : adjustment.points) points.push_back(point.x);
  std::vector<std::optional<Rigid3>> poses;
  for (const TimedPose& pose : AssembleTrajectory(odometry, adjustment, Rigid3())) {
    poses.push_back(pose.world_from_left);
  }
  std::fill_n(poses.begin(), FirstPosedFrame(odometry), std::nullopt);
  const LevelledWorld world = LevelWorld(poses, points, dataset);
  Trajectory trajectory = AssembleTrajectory(odometry, adjustment, world.world_from_gauge);
  return {.adjustment = std::move(adjustment),
          .odometry = odometry,
          .world_from_gauge = world.world_from_gauge,
          .world_up = world.up_source,
          .trajectory = std::move(trajectory)};
}

std::vector<std::optional<Rigid3>> PosesByFrame(const AlignedKeyframes& aligned,
                                                const KeyframeGraph& graph,
                                                std::size_t frame_count) {
  std::vector<std::optional<Rigid3>> poses(frame_count);
  for (std::size_t k = 0; k < aligned.world_from_left.size(); ++k) {
    poses[graph.keyframes[k].frame] = aligned.world_from_left[k];
  }
  return poses;
}

std::vector<std::string> PosesAndPointsOutputs() {
  std::vector<std::string> outputs = kTrajectoryOutputs;
  outputs.insert(outputs.end(), {"sparse", "sparse.ply"});
  return outputs;
}

void PublishPosesAndPoints(const AdjustedPart& part, const Dataset& dataset,
                           Publication& publication) {
  PublishSparse(MakeSparseOutput(dataset, part.adjustment, part.world_from_gauge), dataset,
                publication);
  PublishTrajectory(part.adjustment.rig, part.trajectory, publication);
}

PosedPart PosedByAdjustment(const StageContext&, const Dataset& dataset, const AdjustedPart& part) {
  const Adjustment& adjustment = part.adjustment;
  PosedPart posed{WithFilesOf(dataset, adjustment.rig),
                  part.trajectory,
                  {},
                  {},
                  part.world_up,
                  adjustment.right_turns};
  posed.points_in_left.resize(adjustment.world_from_left.size());
  for (const AdjustedPoint& point : adjustment.points) {
    PosedPoint& seen = posed.points.emplace_back(part.world_from_gauge * point.x);
    for (const PointObservation& o : point.observations) {
      if (o.eye != Eye::kLeft) continue;
      posed.points_in_left[o.frame].push_back(adjustment.world_from_left[o.frame]->Inverse() *
                                              point.x);
      seen.in_left.push_back(o);
    }
  }
  return posed;
}

}  // namespace rigmap
