// The checks of a part: whether its poses and its depths are to be trusted.
#pragma once

#include "gates/gates.h"
#include "pipeline/stage.h"
#include "workflows/stages/adjustment.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/features.h"
#include "workflows/stages/trajectory.h"

namespace rigmap {

using AdjustedGatesCheck = Check<
    Takes<Dataset, FeatureIndex, KeyframeGraph, AlignedKeyframes, AdjustedPart>,
    Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions, CalibrationGateOptions>>;
AdjustedGatesCheck AdjustedGates();

// What of these applies to poses that nothing adjusted.
using OdometricGatesCheck = Check<
    Takes<Dataset, FeatureIndex, Odometry, OdometricPart>,
    Reads<MappingGateOptions, PoseGateOptions, AdjustmentGateOptions, CalibrationGateOptions>>;
OdometricGatesCheck OdometricGates();

using DepthGatesCheck = Check<Takes<DepthIndex>, Reads<DepthGateOptions>>;
DepthGatesCheck DepthGates();

}  // namespace rigmap
