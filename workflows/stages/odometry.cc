#include "workflows/stages/odometry.h"

#include <algorithm>

#include "core/progress.h"
#include "dead_reckoning/bridge_gaps.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/joinable.h"

namespace rigmap {
namespace {

constexpr const char* kJoinableOdometry = "joining/odometry.bin";

Odometry MakeOdometry(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                      const OdometryOptions& options) {
  return TrackAll(dataset, features, options, MatchBy::kDescriptors);
}

Odometry MakeBridged(const StageContext&, const Dataset& dataset, const Odometry& odometry,
                     const DeadReckoningOptions& rover, const FilterOptions& filter) {
  return BridgeGaps(dataset, odometry, rover, filter);
}

Report ReportOdometry(const Odometry& odometry, const Dataset&, const FeatureStore&) {
  return {
      {"frames", {{"keyframes", std::ranges::count(odometry, true, &OdometryFrame::keyframe)}}}};
}

void PublishOdometry(Publication& publication, const StageContext&, const Odometry& odometry,
                     const Dataset&, const FeatureStore&) {
  PublishJoinable(publication, kJoinableOdometry, CodeHere(), odometry);
}

}  // namespace

Odometry TrackAll(const Dataset& dataset, const FeatureStore& features,
                  const OdometryOptions& options, MatchBy match_by,
                  const ExpectedMotion& expected) {
  Progress progress("odometry", dataset.frames.size());
  const auto load = [&](int frame) {
    progress.Set(static_cast<std::size_t>(frame) + 1);
    return features.Get(frame);
  };
  return TrackFrames(features.frame_count(), load, dataset.rig, options, match_by, expected);
}

OdometryStage VisualOdometry() {
  return {
      .name = "odometry",
      .about =
          "metric motion with covariance from keyframe to frame; keyframes; a pose for every frame",
      .code = CodeHere(),
      .make = MakeOdometry,
      .publishes = {kJoinableOdometry},
      .publish = PublishOdometry,
      .report = ReportOdometry};
}

BridgingStage Bridging() {
  return {.name = "bridging",
          .about = "the motion by wheels and gyro where images lose their way or mislead",
          .code = CodeHere(),
          .make = MakeBridged};
}

Odometry ReadJoinableOdometry(const std::filesystem::path& root) {
  return ReadJoinable<Odometry>(root, kJoinableOdometry, CodeHere());
}

}  // namespace rigmap
