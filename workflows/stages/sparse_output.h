// The adjusted part as COLMAP's tools read it.
#pragma once

#include "pipeline/stage.h"
#include "scene/adjustment.h"
#include "scene/dataset.h"
#include "scene/sparse_model.h"

namespace rigmap {

// Both eyes of all adjusted frames and all points, in the world; colours from the first image that
// shows a point (reads each of these once).
SparseModel MakeSparseOutput(const Dataset& dataset, const Adjustment& adjustment,
                             const Rigid3& world_from_gauge);

// sparse/, with a table of the images' original names, and sparse.ply.
void PublishSparse(const SparseModel& model, const Dataset& dataset, Publication& publication);

}  // namespace rigmap
