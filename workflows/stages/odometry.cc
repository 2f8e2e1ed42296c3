#include "workflows/stages/odometry.h"

#include <algorithm>
#include <map>
#include <optional>

#include "core/progress.h"
#include "dead_reckoning/bridge_gaps.h"
#include "features/extract_features.h"
#include "odometry/followed_corners.h"
#include "odometry/lone_views.h"
#include "odometry/searched_ground.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/feature_sampler.h"
#include "workflows/stages/joinable.h"

namespace rigmap {
namespace {

constexpr const char* kJoinableOdometry = "joining/odometry.bin";

Odometry MakeOdometry(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                      const OdometryOptions& options) {
  return TrackAll(dataset, features, options, MatchBy::kDescriptors);
}

// Whatever folder the data lay in when it was looked at.
bool IsSameImage(const std::filesystem::path& a, const std::filesystem::path& b) {
  return a.filename() == b.filename() && a.parent_path().filename() == b.parent_path().filename();
}

// Lone images of stretches, read when they are asked for.
class LoneViews {
 public:
  LoneViews(const Dataset& dataset, const FeatureStore& features, const BridgingOptions& options)
      : dataset_(dataset), features_(features), options_(options) {}

  std::vector<LoneView> Between(StampNs after, StampNs before) {
    std::vector<LoneImage> images = dataset_.lone_images;
    std::erase_if(images, [&](const LoneImage& image) {
      return image.stamp_ns <= after || image.stamp_ns >= before ||
             !std::filesystem::exists(image.path);  // parts are joined without their images, too
    });
    for (std::size_t i = 0; i < dataset_.frames.size(); ++i) {
      const StereoFrame& frame = dataset_.frames[i];
      if (frame.stamp_ns <= after || frame.stamp_ns >= before) continue;
      const auto unreadable = features_.Get(static_cast<int>(i)).unreadable_images;
      if (unreadable.size() != 1) continue;
      const Eye eye = IsSameImage(unreadable.front(), frame.left_path) ? Eye::kRight : Eye::kLeft;
      images.push_back({frame.stamp_ns, eye, frame.PathOf(eye)});
    }
    std::ranges::sort(images, {}, &LoneImage::stamp_ns);
    std::vector<LoneView> views;
    for (const LoneImage& image : images) views.push_back({image.eye, FeaturesOf(image)});
    return views;
  }

 private:
  const FrameFeatures& FeaturesOf(const LoneImage& image) {
    if (!setup_) setup_ = MakeFeatureSetup(dataset_.rig, options_.features, options_.masks);
    auto [known, is_new] = known_.try_emplace(image.path);
    if (is_new) {
      known->second = ExtractLoneFeatures(image, dataset_.frames.front().sample_bits, *setup_);
    }
    return known->second;
  }

  const Dataset& dataset_;
  const FeatureStore& features_;
  const BridgingOptions& options_;
  std::optional<FeatureSetup> setup_;
  std::map<std::string, FrameFeatures> known_;
};

// Corners of pairs of frames, as `rig` sees them.
class Corners {
 public:
  Corners(const Dataset& dataset, const StereoRig& rig, const RigFixedCells& rig_fixed,
          const BridgingOptions& options)
      : dataset_(dataset), rig_(rig), rig_fixed_(rig_fixed), options_(options) {}

  FollowedCorners Follow(int from, int to) {
    const StereoFrame &earlier = dataset_.frames[from], &later = dataset_.frames[to];
    if (!HasImages(earlier) || !HasImages(later)) return {};
    if (!setup_) setup_ = MakeFeatureSetup(rig_, options_.features, options_.masks);
    CornerTracker tracker(*setup_, options_.corners);
    FollowedCorners corners;
    corners.from = tracker.Next(earlier);
    corners.to = tracker.Next(later);
    rig_fixed_.RemoveFrom(corners.from);
    rig_fixed_.RemoveFrom(corners.to);
    return corners;
  }

 private:
  const Dataset& dataset_;
  const StereoRig& rig_;
  const RigFixedCells& rig_fixed_;
  const BridgingOptions& options_;
  std::optional<FeatureSetup> setup_;
};

Odometry MakeBridged(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                     const Odometry& odometry, const FeatureOptions& of_features,
                     const CornerOptions& corners, const MaskOptions& masks,
                     const OdometryOptions& options, const DeadReckoningOptions& rover,
                     const FilterOptions& filter) {
  return Bridged(dataset, dataset.rig, features, odometry,
                 {of_features, corners, masks, options, rover, filter});
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

Odometry Bridged(const Dataset& dataset, const StereoRig& rig, const FeatureStore& features,
                 Odometry odometry, const BridgingOptions& options) {
  Corners corners(dataset, rig, features.rig_fixed(), options);
  const auto follow = [&](int from, int to) { return corners.Follow(from, to); };
  odometry = BridgeByCorners(std::move(odometry), follow, rig, options.odometry);
  LoneViews views(dataset, features, options);
  const auto between = [&](StampNs after, StampNs before) { return views.Between(after, before); };
  odometry =
      BridgeByLoneViews(std::move(odometry), features.AsSource(), between, rig, options.odometry);
  odometry = BridgeGaps(dataset, std::move(odometry), options.rover, options.filter);
  return BridgeBySearch(
      std::move(odometry), features.AsSource(),
      SamplerOf(dataset, rig, features.rig_fixed(), options.features, options.masks), rig,
      options.odometry);
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
          .about =
              "the motion where keypoints lose their way: by corners that are followed, by lone "
              "images, by wheels and gyro, by ground searched where these put it",
          .code = CodeHere(),
          .make = MakeBridged};
}

Odometry ReadJoinableOdometry(const std::filesystem::path& root) {
  return ReadJoinable<Odometry>(root, kJoinableOdometry, CodeHere());
}

}  // namespace rigmap
