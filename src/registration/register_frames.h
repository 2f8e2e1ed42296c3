// Clouds of frames chained to a trajectory.
#pragma once

#include <functional>
#include <vector>

#include "registration/frame_cloud.h"
#include "registration/registration.h"
#include "registration/registration_options.h"
#include "scene/odometry.h"
#include "scene/rig.h"
#include "trajectory/motion_model.h"

namespace rigmap {

// The cloud of a frame; empty where it shows nothing.
using CloudSource = std::function<FrameCloud(int frame)>;

// Each cloud is registered against those of the last keyframes, and its pose hangs on the last of
// them. `odometry`: what was measured otherwise (by the images, or by wheels, as the first guess is
// asked for), for first guesses and the stamps; an entry per
// frame. Frames that cannot be registered are predicted; the plain way chains also
// those that no surface holds, with the sigmas of a prediction. Holds the clouds of the keyframes
// and of two frames more. Runs in one thread: the order of frames is what makes a chain.
// `rig`: by which the clouds were made, for what an offset of its disparities does to them.
Registration RegisterFrames(const CloudSource& clouds, const Odometry& odometry,
                            const StereoRig& rig, double grid_m, const RegistrationOptions& options,
                            const UnmeasuredMotion& unmeasured);

}  // namespace rigmap
