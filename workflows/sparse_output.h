// The adjusted part as COLMAP's tools read it.
#pragma once

#include <filesystem>
#include <string>

#include "scene/adjustment.h"
#include "scene/dataset.h"
#include "scene/sparse_model.h"
#include "workflows/output_folder.h"

namespace rigmap {

// Makes `images`/left and right hold a link per frame to its file.
void LinkImages(const Dataset& dataset, const std::filesystem::path& images);

// Both eyes of all adjusted frames and all points, in the world; colours from the first image that
// shows a point (reads each of these once).
SparseModel MakeSparseOutput(const Dataset& dataset, const Adjustment& adjustment,
                             const Rigid3& world_from_gauge);

// sparse/ and sparse.ply.
void WriteSparseOutput(const SparseModel& model, const OutputLayout& layout);

}  // namespace rigmap
