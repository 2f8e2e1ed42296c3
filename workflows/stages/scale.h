// The stage `scale`: lays the models into the world, in metres.
#pragma once

#include "pipeline/stage.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

using ScaleStage = Stage<AlignedKeyframes, Takes<Odometry, KeyframeGraph, MeasuredModels>, Reads<>>;
ScaleStage Scale();

// What summary.json says of keyframes that got their metres from left-right distances.
Report ReportAligned(const AlignedKeyframes& aligned);

}  // namespace rigmap
