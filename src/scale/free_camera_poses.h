// Metres for models of free cameras.
#pragma once

#include <optional>

#include "scale/scale_options.h"
#include "scene/aligned_keyframes.h"
#include "scene/rig.h"
#include "scene/sparse_model.h"

namespace rigmap {

// The frames of a model whose left and right cameras were posed apart from each other. Its scale is
// the rig's baseline over the mean left-right distance, outliers rejected. A frame's rig stands
// where the midpoint between its two cameras is, turned as their mean; a frame of which only one
// image was registered follows that camera. The world is the rig's left camera of the first frame.
// Nothing of it where no frame has both.
AlignedKeyframes PoseFreeCameras(const std::vector<SparseModel>& models, int frame_count,
                                 const StereoRig& rig, const ScaleOptions& options);

// The largest relative change of a focal length that the rig states, among a model's cameras; a
// half counts as much as the double, 1.
// COLMAP frees them by default, and on a short or straight way something else makes up for a wrong
// one: lengths across the way and along it then differ by about as much, and no left-right distance
// tells. 0 where the model has no cameras.
double FocalLengthChange(const SparseModel& model, const StereoRig& rig);

// By what share depths that the left camera of a model sees, in metres by `metres_per_model_unit`,
// differ from those that the rig file makes of the same two pixels: of the median of each frame the
// root mean square over frames. Free cameras turn against each other from frame to frame, by which
// the same left-right distance means other metres. Nothing where no frame has kLeastSharedPoints
// such points.
inline constexpr std::size_t kLeastSharedPoints = 10;
std::optional<double> DepthChange(const SparseModel& model, double metres_per_model_unit,
                                  const StereoRig& rig);

}  // namespace rigmap
