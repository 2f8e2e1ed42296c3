// The stage `scale`: lays the models into the world, in metres.
#pragma once

#include "pipeline/stage.h"
#include "workflows/stages/mapping.h"

namespace rigmap {

using ScaleStage = Stage<AlignedKeyframes, Takes<Odometry, KeyframeGraph, MeasuredModels>, Reads<>>;
ScaleStage Scale();

}  // namespace rigmap
