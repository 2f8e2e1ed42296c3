// The stage `merging`: leaves dense.ply, the clouds of all frames laid over each other.
#pragma once

#include "registration/registration_options.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/registration.h"

namespace rigmap {

using MergingStage =
    Stage<FusedMap, Takes<Dataset, PosedPart, DepthIndex>, Reads<CloudOptions, MergeOptions>>;
MergingStage CloudMerging();

}  // namespace rigmap
