// The stage `las`: leaves dense.las, if the map has any point and it is asked for.
#pragma once

#include <filesystem>

#include "export/las.h"
#include "export/las_options.h"
#include "pipeline/published.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/gates.h"
#include "workflows/stages/georeference.h"

namespace rigmap {

// A PLY file as LAS. Reads it twice, block by block. Throws DataError naming the file.
void WriteLasOf(const std::filesystem::path& ply, const LasFrame& frame, std::ostream& stream);

// On the grid, or as it is in the world.
LasFrame LasFrameOn(const std::optional<GridFrame>& grid, const std::string& warning);

using LasStage = Stage<Published, Takes<FusedMap, Warning, Georeferenced>, Reads<LasOptions>>;
LasStage LasFile();

}  // namespace rigmap
