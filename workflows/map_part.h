// How a part is mapped, and what is done when that fails.
#pragma once

#include "colmap/installation.h"
#include "mapping/map_keyframes.h"
#include "workflows/part_options.h"

namespace rigmap {

// As mapping.method says. Where a seeded map fails a gate on it, the odometric poses are
// triangulated; that is taken, and a remark says so, if it passes. What was triangulated on the
// odometry is adjusted freely (AdjustFreely) before it is judged. Leaves the models taken in
// paths.models.
MappingResult MapPart(const ColmapInstallation& colmap, const GraphWithPoses& input,
                      const MappingPaths& paths, const PartOptions& options, int threads);

}  // namespace rigmap
