// The stage `odometry`: consecutive stereo frames become metric motion.
#pragma once

#include <functional>
#include <optional>

#include "geometry/rigid3.h"
#include "odometry/odometry_options.h"
#include "scene/features.h"
#include "scene/odometry.h"
#include "scene/rig.h"

namespace rigmap {

// What tells that two frames show the same point.
enum class MatchBy { kDescriptors, kTracks };

// to_from_from, about, where it is known already. Frames as TrackFrames counts them.
using ExpectedMotion = std::function<std::optional<Rigid3>(int from, int to)>;

// Poses `frame_count` frames one after the other: each is matched with the last keyframe near where
// the motion so far predicts its points, else everywhere; where that fails the frame before becomes
// a keyframe and is tried; where that fails too the motion is carried on (source predicted) and
// tracking starts anew, but the keyframe that was lost is tried until something is found. Predicted
// frames between two posed ones are put between them. It begins with the first frame that shows
// enough to pose others against: those before it are posed against it, else predicted backwards in
// time. Holds three frames' features at a time and asks for each a few times. Matches by tracks
// need no search.
// What is `expected` of the motion between two frames stands where the motion so far would.
Odometry TrackFrames(int frame_count, const FeatureSource& features, const StereoRig& rig,
                     const OdometryOptions& options, MatchBy match_by = MatchBy::kDescriptors,
                     const ExpectedMotion& expected = {});

}  // namespace rigmap
