// Depth maps as the undistorted workspace from which COLMAP's fusion and meshing go on.
#pragma once

#include "pipeline/stage.h"
#include "scene/dataset.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/posed_part.h"

namespace rigmap {

// dense_workspace/ (colmap/dense_workspace.h): the rectified left view, depth and normals of each
// frame with depth, on one camera, in the world; nothing where no frame has depth. Frames are
// written side by side, as many as --memory allows.
void PublishDenseWorkspace(const Dataset& dataset, const PosedPart& part, const DepthIndex& depths,
                           const StageContext& context, Publication& publication);

}  // namespace rigmap
