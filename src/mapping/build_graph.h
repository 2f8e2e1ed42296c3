// The stage `database`: keyframes and correspondences as COLMAP's database holds them.
#pragma once

#include "colmap/database.h"
#include "mapping/mapping_options.h"
#include "scene/dataset.h"
#include "scene/keyframe_graph.h"
#include "scene/odometry.h"

namespace rigmap {

// Chooses the tracks that COLMAP maps with: longest first, until every keyframe that can has its
// share. Names images after the frames' stamps and the files' extensions.
KeyframeGraph BuildKeyframeGraph(const Correspondences& correspondences, const Odometry& odometry,
                                 const Dataset& dataset, const KeyframeGraphOptions& options);

// Both cameras, two images per keyframe, stereo matches and, along every track, matches of each
// left keypoint with the next few (COLMAP itself passes over pairs of images with less than 15).
DatabaseContent MakeDatabaseContent(const KeyframeGraph& graph,
                                    const Correspondences& correspondences, const StereoRig& rig);

}  // namespace rigmap
