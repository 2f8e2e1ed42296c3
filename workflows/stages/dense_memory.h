// How much memory dense matching may take, and what cannot fit.
#pragma once

#include "dense/dense_options.h"
#include "imaging/mask_options.h"
#include "scene/rig.h"

namespace rigmap {

// How many frames of `frame_mb` are dense-matched at once where `room_mb` of the allowed megabytes
// are left to the stage: at most `threads`; 0 where not even one fits: then it has to be the only
// one in the process. Throws UsageError where one does not fit beside nothing but the program.
// `nearest_m` is what it is searched down to.
struct DenseRoom {
  double room_mb = 0.0;
  int allowed_mb = 0, threads = 1;
};
int FramesAtOnce(double frame_mb, double nearest_m, const DenseRoom& room);

// Throws as FramesAtOnce, for images of this rig however near the things are that they show. What
// one depth map takes.
double RequireMemoryForDepth(const StereoRig& rig, const DenseOptions& options,
                             const MaskOptions& masks, int allowed_mb);

}  // namespace rigmap
