// Points for the adjustment, triangulated from tracks.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/lens_field.h"
#include "adjustment/internal/rig_flexure.h"
#include "scene/adjustment.h"
#include "scene/correspondences.h"

namespace rigmap {

// True if more than one frame shows the point. Observations stand in order of frames.
bool SpansFrames(const AdjustedPoint& point);

// True if it does, and two of the cameras that show it stand at least a hundredth of the rig's
// baseline apart. Of a point that only a standing rig shows, in one eye, there is a direction but
// no depth: the adjustment would be free to move it into the camera, where its equations blow up.
bool IsDetermined(const AdjustedPoint& point, const StereoRig& rig,
                  const std::vector<std::optional<Rigid3>>& left_from_world);

// Triangulates every track over the frames that have a pose (left_from_world; frames without one
// are passed over). Observations that lie further than max_error_px from the point's image are
// dropped, the worst first, the point being triangulated anew each time. Tracks of which fewer than
// two frames are left, or whose depth is not determined, are left out, as are those beyond the
// depth limit (from the first frame). Flexure and a field, if there are such, move the pixels.
std::vector<AdjustedPoint> TriangulateTracks(
    const std::vector<Track>& tracks, const Correspondences& correspondences, const StereoRig& rig,
    const std::vector<std::optional<Rigid3>>& left_from_world, double max_error_px,
    double max_depth_m, const LensField* field = nullptr, const RigFlexure* flexure = nullptr);

}  // namespace rigmap
