// Whether wheels and gyro, where a rover has them, bear the images out.
#pragma once

#include "dead_reckoning/dead_reckoning_options.h"
#include "pipeline/stage.h"
#include "scene/dataset.h"
#include "workflows/stages/adjustment.h"

namespace rigmap {

using SensorGatesCheck =
    Check<Takes<Dataset, AdjustedPart>, Reads<DeadReckoningOptions, FilterOptions>>;
SensorGatesCheck SensorGates();

}  // namespace rigmap
