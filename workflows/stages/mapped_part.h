// The stage `trajectory` of techniques that leave COLMAP's poses as they are: leaves trajectories
// and sparse/.
#pragma once

#include "colmap/installation.h"
#include "pipeline/stage.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

// COLMAP's poses times the baseline, as `scale` has laid them into the world.
using MappedPartStage =
    Stage<AdjustedPart, Takes<Dataset, Odometry, KeyframeGraph, MeasuredModels, AlignedKeyframes>,
          Reads<MappingOptions>>;
// Throws DataError where COLMAP's mapping, in the way that was asked for, led to no model.
MappedPartStage MappedTrajectory();

}  // namespace rigmap
