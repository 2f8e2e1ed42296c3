#include "workflows/stages/odometry.h"

#include <algorithm>

#include "core/progress.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

Odometry MakeOdometry(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                      const OdometryOptions& options) {
  return TrackAll(dataset, features, options, MatchBy::kDescriptors);
}

Report ReportOdometry(const Odometry& odometry, const Dataset&, const FeatureStore&) {
  return {
      {"frames", {{"keyframes", std::ranges::count(odometry, true, &OdometryFrame::keyframe)}}}};
}

}  // namespace

Odometry TrackAll(const Dataset& dataset, const FeatureStore& features,
                  const OdometryOptions& options, MatchBy match_by) {
  Progress progress("odometry", dataset.frames.size());
  const auto load = [&](int frame) {
    progress.Set(static_cast<std::size_t>(frame) + 1);
    return features.Get(frame);
  };
  return TrackFrames(features.frame_count(), load, dataset.rig, options, match_by);
}

OdometryStage VisualOdometry() {
  return {
      .name = "odometry",
      .about =
          "metric motion with covariance from keyframe to frame; keyframes; a pose for every frame",
      .code = CodeHere(),
      .make = MakeOdometry,
      .report = ReportOdometry};
}

}  // namespace rigmap
