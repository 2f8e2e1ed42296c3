#include "workflows/adjust_part.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "adjustment/adjust.h"
#include "adjustment/level_world.h"
#include "gates/gates.h"
#include "odometry/track_frames.h"
#include "pose_graph/relax_poses.h"
#include "trajectory/assemble_trajectory.h"
#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

// The gauge of the adjustment laid into the world, and a pose for every frame.
AdjustedPart LayInWorld(const Dataset& dataset, const Odometry& odometry,
                        const Adjustment& adjustment) {
  std::vector<Eigen::Vector3d> points;
  for (const AdjustedPoint& point : adjustment.points) points.push_back(point.x);
  std::vector<std::optional<Rigid3>> poses;
  for (const TimedPose& pose : AssembleTrajectory(odometry, adjustment, Rigid3())) {
    poses.push_back(pose.world_from_left);
  }
  std::fill_n(poses.begin(), FirstPosedFrame(odometry), std::nullopt);
  const LevelledWorld world = LevelWorld(poses, points, dataset);
  return {adjustment,
          odometry,
          world.world_from_gauge,
          world.up_source,
          AssembleTrajectory(odometry, adjustment, world.world_from_gauge),
          {}};
}

class PartAdjuster {
 public:
  explicit PartAdjuster(const PartToAdjust& part) : part_(part) {}

  AdjustedPart Run() const {
    AdjustedPart best = From(part_.mapped, part_.odometry, CalibrationVector::Zero());
    if (best.adjustment.IsRigCorrected()) {
      const CalibrationVector correction = best.adjustment.rig_correction;
      best = From({}, TrackWith(best.adjustment.rig), correction);
      best.remarks.push_back(
          "the images contradict the calibration: the rig was corrected (rig_refined.yaml), the "
          "odometry done anew with it");
    }
    const Gates failed = Judge(best);
    // With a corrected rig it has started from the odometry already.
    if (AllPassed(failed) || best.adjustment.IsRigCorrected()) return best;
    AdjustedPart other = From({}, part_.odometry, CalibrationVector::Zero());
    const bool is_better = AllPassed(Judge(other));
    const std::string remark =
        fmt::format("{}; adjusting from the odometric poses {}", FailureReason(failed),
                    is_better ? "gave the result instead" : "did not mend it");
    spdlog::warn("{}", remark);
    AdjustedPart& kept = is_better ? other : best;
    kept.remarks.push_back(remark);
    return kept;
  }

 private:
  AdjustedPart From(const std::vector<std::optional<Rigid3>>& mapped, const Odometry& odometry,
                    const CalibrationVector& correction) const {
    const auto starting =
        RelaxPoses(StartingPoses(odometry, mapped), odometry, part_.matches.revisits);
    const Adjustment adjustment = AdjustBundle(
        {part_.matches, part_.dataset.rig, starting, correction}, part_.options.adjustment);
    return LayInWorld(part_.dataset, odometry, adjustment);
  }

  // Which frames are keyframes stays as it was: they have been matched.
  Odometry TrackWith(const StereoRig& rig) const {
    const int count = static_cast<int>(part_.odometry.size());
    Odometry odometry = TrackFrames(count, part_.features, rig, part_.options.odometry);
    for (int i = 0; i < count; ++i) odometry[i].keyframe = part_.odometry[i].keyframe;
    return odometry;
  }

  Gates Judge(const AdjustedPart& part) const {
    return JudgeAdjustment({part_.dataset.rig, part.odometry, part.adjustment, part.trajectory},
                           part_.options.gates.adjustment);
  }

  const PartToAdjust& part_;
};

}  // namespace

AdjustedPart AdjustPart(const PartToAdjust& part) { return PartAdjuster(part).Run(); }

}  // namespace rigmap
