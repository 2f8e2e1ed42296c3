#include "workflows/stages/tracked_features.h"

#include "core/artefact.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "odometry/track_frames.h"
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

// What is known of all frames, from what is kept of each.
FeatureIndex IndexOf(const StageContext& context, std::vector<FrameFile> files) {
  FeatureIndex index{.files = std::move(files)};
  for (std::size_t i = 0; i < index.files.size(); ++i) {
    const FrameFile& file = index.files[i];
    const auto frame = ReadArtefact<FrameFeatures>(file.In(context.root), file.key).value();
    if (!frame.epipolar_errors_px.empty()) {
      index.epipolar_px.push_back(MedianAbsolute(frame.epipolar_errors_px));
    }
    if (frame.unreadable_images.empty()) continue;
    index.unreadable_frames.push_back(static_cast<int>(i));
    index.unreadable_images.insert(index.unreadable_images.end(), frame.unreadable_images.begin(),
                                   frame.unreadable_images.end());
  }
  return index;
}

FeatureIndex MakeTracked(const StageContext& context, const Dataset& dataset,
                         const DatasetContent& content, const CornerOptions& corners,
                         const FeatureOptions& options, const MaskOptions& masks) {
  const std::vector<FrameFile> files =
      FilesOf(dataset, content,
              std::string(CodeHere()) + content.rig + OptionsText(corners) + OptionsText(options) +
                  OptionsText(masks));
  CornerTracker tracker(MakeFeatureSetup(dataset.rig, options, masks), corners);
  Progress progress("features", dataset.frames.size());
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    WriteArtefact(files[i].In(context.root), files[i].key, tracker.Next(dataset.frames[i]));
    progress.Advance();
  }
  ForgetOlderFrames(context.root, files);
  return IndexOf(context, files);
}

Odometry MakeTrackedOdometry(const StageContext&, const Dataset& dataset,
                             const FeatureStore& features, const OdometryOptions& options) {
  Progress progress("odometry", dataset.frames.size());
  const auto load = [&](int frame) {
    progress.Set(static_cast<std::size_t>(frame) + 1);
    return features.Get(frame);
  };
  return TrackFrames(features.frame_count(), load, dataset.rig, options, MatchBy::kTracks);
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
