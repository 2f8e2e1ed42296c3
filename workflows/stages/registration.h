// The stage `registration`: clouds of all frames chained by ICP.
#pragma once

#include "odometry/odometry_options.h"
#include "pipeline/stage.h"
#include "registration/register_frames.h"
#include "scene/dataset.h"
#include "workflows/stages/dense.h"

namespace rigmap {

using RegistrationStage = Stage<Registration, Takes<Dataset, Odometry, DepthIndex>,
                                Reads<CloudOptions, RegistrationOptions, OdometryOptions>>;
RegistrationStage CloudRegistration();

// A view: its poses, as those of any odometry.
Odometry RegisteredMotion(const StageContext& context, const Registration& registration);

// The cloud of an index's frame, by its depth map.
FrameCloud ReadCloud(const StageContext& context, const FrameFile& depth,
                     const CloudLimits& limits);

}  // namespace rigmap
