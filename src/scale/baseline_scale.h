// The stage `scale`: metres out of the distances between left and right cameras.
#pragma once

#include <optional>
#include <vector>

#include "scale/scale_options.h"
#include "scene/aligned_keyframes.h"
#include "scene/sparse_model.h"

namespace rigmap {

// From every keyframe that has both eyes in the model. Nothing if there is none. Does not depend on
// the model's gauge, and scales inversely with it.
std::optional<BaselineScale> MeasureBaseline(const SparseModel& model, double baseline_m,
                                             const ScaleOptions& options);

// Of each model; nothing for one without a stereo pair.
using ModelScales = std::vector<std::optional<BaselineScale>>;
ModelScales MeasureBaselines(const std::vector<SparseModel>& models, double baseline_m,
                             const ScaleOptions& options);

// Scales each model and joins them: the first is aligned with the odometric pose of its earliest
// keyframe, each further one with the nearest keyframe already aligned, by the odometry between the
// two. Only keyframes whose pair was used serve for that. A model without a scale is left out.
// `odometric` holds world_from_left per keyframe. Where models share a keyframe the earlier model's
// pose stays.
AlignedKeyframes AlignModels(const std::vector<SparseModel>& models, const ModelScales& scales,
                             const std::vector<Rigid3>& odometric);

}  // namespace rigmap
