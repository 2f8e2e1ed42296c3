// The stage `steps`: what each step towards the adjusted trajectory adds. Leaves steps/*.tum.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/stage.h"
#include "workflows/stages/adjusted_part.h"

namespace rigmap {

// The trajectory of the part as it would be if it ended with this step; in the world of the
// adjusted one, laid on its first posed frame.
inline constexpr std::array kStepNames{"odometry", "mapping", "parts", "adjustment"};
struct Step {
  std::string name;
  Trajectory trajectory;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, trajectory);
  }
};

using Steps = std::vector<Step>;

// A pose for every frame where these are known, laid on the final trajectory's first posed frame.
Trajectory AssembleStep(const Odometry& odometry, std::vector<std::optional<Rigid3>> known,
                        const Trajectory& final_trajectory);
// steps/<name>.tum of each.
void PublishSteps(Publication& publication, const Steps& steps);

using StepsStage =
    Stage<Steps, Takes<Odometry, KeyframeGraph, AlignedKeyframes, AdjustedPart>, Reads<>>;
StepsStage TrajectorySteps();

// A view, for techniques of one step.
Steps NoSteps(const StageContext& context, const PosedPart& part);

}  // namespace rigmap
