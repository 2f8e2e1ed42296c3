#include "workflows/stages/steps.h"

#include "core/file.h"
#include "export/tum.h"
#include "pipeline/code_identity.h"
#include "trajectory/assemble_trajectory.h"
#include "trajectory/starting_poses.h"

namespace rigmap {
namespace {

Steps MakeSteps(const StageContext&, const Odometry& odometry, const KeyframeGraph& graph,
                const AlignedKeyframes& aligned, const AdjustedPart& part) {
  const std::size_t count = odometry.size();
  Steps steps{{kStepNames[0],
               AssembleStep(odometry, std::vector<std::optional<Rigid3>>(count), part.trajectory)}};
  if (!aligned.models.empty()) {
    steps.push_back({kStepNames[1],
                     AssembleStep(odometry, PosesByFrame(aligned, graph, count), part.trajectory)});
  }
  steps.push_back({kStepNames[3], part.trajectory});
  return steps;
}

void PublishTrajectorySteps(Publication& publication, const StageContext&, const Steps& steps,
                            const Odometry&, const KeyframeGraph&, const AlignedKeyframes&,
                            const AdjustedPart&) {
  PublishSteps(publication, steps);
}

}  // namespace

Trajectory AssembleStep(const Odometry& odometry, std::vector<std::optional<Rigid3>> known,
                        const Trajectory& final_trajectory) {
  const int first = FirstPosedFrame(odometry);
  Adjustment poses;
  poses.world_from_left = std::move(known);
  poses.datum_frames.assign(odometry.size(), first);
  const Rigid3 gauge_from_first =
      poses.world_from_left[first].value_or(odometry[first].world_from_left);
  return AssembleTrajectory(odometry, poses,
                            final_trajectory[first].world_from_left * gauge_from_first.Inverse());
}

void PublishSteps(Publication& publication, const Steps& steps) {
  publication.Folder("steps", [&](const std::filesystem::path& folder) {
    for (const Step& step : steps) {
      WriteFileAtomically(folder / (step.name + ".tum"),
                          [&](std::ostream& stream) { stream << WriteTum(step.trajectory); });
    }
  });
}

StepsStage TrajectorySteps() {
  return {.name = "steps",
          .about =
              "the trajectory as it was after odometry, after mapping times baseline, and "
              "after the adjustment",
          .code = CodeHere(),
          .make = MakeSteps,
          .publishes = {"steps"},
          .publish = PublishTrajectorySteps};
}

Steps NoSteps(const StageContext&, const PosedPart&) { return {}; }

}  // namespace rigmap
