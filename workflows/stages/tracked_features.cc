#include "workflows/stages/tracked_features.h"

#include "core/artefact.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "correspondence/stereo_points.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

// A frame's features rest on all frames before it: so does its key.
std::vector<FrameFile> FilesOf(const Dataset& dataset, const DatasetContent& content,
                               std::string how) {
  std::vector<FrameFile> files;
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    how = HashText(how + content.frames[i]);
    files.push_back(FrameFileOf("features", dataset.frames[i].stamp_ns, how));
  }
  return files;
}

void Add(int frame, const FrameFeatures& features, const StereoRig& rig, FeatureIndex& index) {
  if (const auto near_m = NearDepth(features.features, rig)) {
    index.near_m.push_back(static_cast<float>(*near_m));
  }
  if (!features.epipolar_errors_px.empty()) {
    index.epipolar_px.push_back(MedianAbsolute(features.epipolar_errors_px));
  }
  if (features.unreadable_images.empty()) return;
  index.unreadable_frames.push_back(frame);
  index.unreadable_images.insert(index.unreadable_images.end(), features.unreadable_images.begin(),
                                 features.unreadable_images.end());
}

FeatureIndex MakeTracked(const StageContext& context, const Dataset& dataset,
                         const DatasetContent& content, const CornerOptions& corners,
                         const FeatureOptions& options, const MaskOptions& masks) {
  FeatureIndex index;
  index.files = FilesOf(dataset, content,
                        std::string(CodeHere()) + content.rig + OptionsText(corners) +
                            OptionsText(options) + OptionsText(masks));
  CornerTracker tracker(MakeFeatureSetup(dataset.rig, options, masks), corners);
  Progress progress("features", dataset.frames.size());
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    const FrameFeatures features = tracker.Next(dataset.frames[i]);
    WriteArtefact(index.files[i].In(context.root), index.files[i].key, features);
    Add(static_cast<int>(i), features, dataset.rig, index);
    progress.Advance();
  }
  ForgetOlderFrames(context.root, index.files);
  return index;
}

Odometry MakeTrackedOdometry(const StageContext&, const Dataset& dataset,
                             const FeatureStore& features, const OdometryOptions& options) {
  return TrackAll(dataset, features, options, MatchBy::kTracks);
}

}  // namespace

TrackedFeaturesStage TrackedFeatures() {
  const FeaturesStage found = Features();
  return {.name = found.name,
          .about =
              "corners followed from frame to frame (KLT), with stereo matches in the right "
              "image",
          .code = CodeHere(),
          .make = MakeTracked,
          .is_whole = found.is_whole,
          .report = found.report};
}

OdometryStage TrackedOdometry() {
  OdometryStage stage = VisualOdometry();
  stage.about = "metric motion as odometry finds it, from matches by tracks";
  stage.code = CodeHere();
  stage.make = MakeTrackedOdometry;
  return stage;
}

}  // namespace rigmap
