// The stage `views`: leaves pictures of the map, if it has any point.
#pragma once

#include "workflows/stages/raster.h"

namespace rigmap {

using ViewsStage = Stage<Published, Takes<PosedPart, FusedMap, Warning>, Reads<PictureOptions>>;
ViewsStage Pictures();

}  // namespace rigmap
