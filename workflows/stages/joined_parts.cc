#include "workflows/stages/joined_parts.h"

#include <algorithm>

#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

FeatureIndex MakeFeatures(const StageContext& context, const Dataset& dataset,
                          const JoinedParts& parts) {
  FeatureIndex index{.files = parts.features,
                     .epipolar_px = parts.epipolar_px,
                     .unreadable_frames = parts.unreadable_frames,
                     .unreadable_images = parts.unreadable_images};
  const FeatureStore all = OpenFeatures(context, index);  // of which none is the rig's yet
  index.rig_fixed = FindRigFixed(all.frame_count(), all.AsSource(), dataset.rig.left.camera);
  return index;
}

bool AreFeaturesThere(const StageContext& context, const FeatureIndex& index) {
  return AreThere(context.root, index.files);
}

Report ReportFeatures(const FeatureIndex& index, const Dataset&, const JoinedParts&) {
  return {{"health", {{"unreadable_images", index.unreadable_images}}}};
}

Odometry MakeOdometry(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                      const JoinedParts& parts, const OdometryOptions& options) {
  Odometry odometry = TrackAll(dataset, features, options, MatchBy::kDescriptors);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    odometry[i].keyframe = parts.keyframes[i] != 0;
  }
  return odometry;
}

Report ReportOdometry(const Odometry& odometry, const Dataset&, const FeatureStore&,
                      const JoinedParts&) {
  return {
      {"frames", {{"keyframes", std::ranges::count(odometry, true, &OdometryFrame::keyframe)}}}};
}

}  // namespace

JoinedFeaturesStage JoinedFeatures() {
  return {.name = "features",
          .about = "keypoints as the parts found them",
          .code = CodeHere(),
          .make = MakeFeatures,
          .is_whole = AreFeaturesThere,
          .report = ReportFeatures};
}

JoinedOdometryStage JoinedOdometry() {
  return {.name = "odometry",
          .about = "metric motion over all parts and across their seams; the parts' keyframes",
          .code = CodeHere(),
          .make = MakeOdometry,
          .report = ReportOdometry};
}

Report ReportParts(const JoinedParts& parts) {
  Report list = Report::array();
  for (const JoinedParts::Part& part : parts.parts) {
    list.push_back({{"name", part.name},
                    {"frames", part.frames},
                    {"shared_with_earlier", part.shared},
                    {"status", part.status.empty() ? Report(nullptr) : Report(part.status)}});
  }
  return {{"parts", std::move(list)}};
}

}  // namespace rigmap
