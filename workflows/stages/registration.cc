#include "workflows/stages/registration.h"

#include <algorithm>

#include "core/progress.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

Registration MakeRegistration(const StageContext& context, const Dataset& dataset,
                              const Odometry& odometry, const DepthIndex& depths,
                              const CloudOptions& clouds, const RegistrationOptions& options,
                              const OdometryOptions& motion) {
  const CloudLimits limits = LimitsFor(dataset.rig, depths.near_m, clouds);
  Progress progress("registration", odometry.size());
  const auto cloud_of = [&](int frame) -> FrameCloud {
    progress.Set(static_cast<std::size_t>(frame) + 1);
    const auto found = std::ranges::lower_bound(depths.frames, frame);
    if (found == depths.frames.end() || *found != frame) return {};
    return ReadCloud(context, depths.files[found - depths.frames.begin()], limits);
  };
  return RegisterFrames(cloud_of, odometry, dataset.rig, limits.grid_m, options,
                        {motion.speed_change_share, motion.turn_change_rad_per_s});
}

Report ReportRegistration(const Registration& registration, const Dataset&, const Odometry&,
                          const DepthIndex&) {
  return {{"frames",
           {{"keyframes", std::ranges::count(registration.motion, true, &OdometryFrame::keyframe)},
            {"registered", std::ranges::count(registration.motion, PoseSource::kOdometry,
                                              &OdometryFrame::source)}}}};
}

}  // namespace

RegistrationStage CloudRegistration() {
  return {.name = "registration",
          .about = "clouds of all frames, each registered by ICP against those before",
          .code = CodeHere(),
          .make = MakeRegistration,
          .report = ReportRegistration};
}

Odometry RegisteredMotion(const StageContext&, const Registration& registration) {
  return registration.motion;
}

FrameCloud ReadCloud(const StageContext& context, const FrameFile& depth,
                     const CloudLimits& limits) {
  return CloudOf(ReadDepth(depth.In(context.root), depth.key), limits);
}

}  // namespace rigmap
