#include "odometry/track_frames.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "odometry/internal/find_motion.h"
#include "trajectory/motion_model.h"

namespace rigmap {
namespace {

bool NeedsKeyframe(const Found& found, const Reference& reference, const StereoRig& rig,
                   const OdometryOptions& options) {
  return found.inliers < options.keyframe_min_seen_share * reference.point_count ||
         found.median_shift_px > options.keyframe_max_shift_share * rig.left.camera.width;
}

// True where there is enough to pose other frames against.
bool CanCarry(const Reference& reference, const OdometryOptions& options) {
  return reference.point_count >= options.min_inliers;
}

// Of frames counted from `start`.
ExpectedMotion CountedFrom(int start, const ExpectedMotion& expected) {
  if (!expected || start == 0) return expected;
  return [=](int from, int to) { return expected(start + from, start + to); };
}

// Follows frames from the first it is given; counts them from 0, as `expected` does.
class Tracker {
 public:
  Tracker(const StereoRig& rig, const OdometryOptions& options, MatchBy match_by,
          ExpectedMotion expected)
      : rig_(rig),
        options_(options),
        match_by_(match_by),
        expected_(expected ? std::move(expected) : [](int, int) { return std::nullopt; }) {}

  void Start(FrameFeatures features) {
    OdometryFrame frame{.stamp_ns = features.stamp_ns};
    keyframe_ = MakeReference(0, std::move(features), rig_, options_);
    // Where no frame shows anything not even the first is a measurement.
    if (CanCarry(keyframe_, options_)) frame.source = PoseSource::kOdometry;
    frame.keyframe = true;
    odometry_.push_back(frame);
    previous_ = keyframe_;
  }

  void Add(FrameFeatures features) {
    const int index = static_cast<int>(odometry_.size());
    const Rigid3 predicted = Predict(features.stamp_ns);
    const auto found = FindFromAny(features, predicted);
    OdometryFrame& frame = odometry_.emplace_back();
    frame.stamp_ns = features.stamp_ns;
    if (found) {
      SetPose(*found, keyframe_.frame, odometry_[keyframe_.frame].world_from_left, options_, frame);
    } else {
      frame.world_from_left = predicted;
      frame.reference = index - 1;
      spdlog::info("{}: no motion found, predicted", FormatSeconds(frame.stamp_ns));
    }
    previous_ = MakeReference(index, std::move(features), rig_, options_);
    if (!NeedsKeyframeNow(found)) return;
    if (!found && !before_loss_) before_loss_ = std::move(keyframe_);
    PromotePrevious();
  }

  Odometry Finish() {
    BridgePredicted(odometry_);
    return std::move(odometry_);
  }

 private:
  // Against the keyframe, else the frame before, else the keyframe that was lost: the one that
  // served is the keyframe from then on.
  std::optional<Found> FindFromAny(const FrameFeatures& current, const Rigid3& predicted) {
    auto found = FindFrom(keyframe_, current, predicted);
    if (!found && previous_.frame != keyframe_.frame && CanCarry(previous_, options_)) {
      PromotePrevious();
      found = FindFrom(keyframe_, current, predicted);
    }
    if (!found && before_loss_) {
      found = FindFrom(*before_loss_, current, predicted);
      if (found) TakeUpLost();
    }
    if (found) before_loss_.reset();
    return found;
  }

  // What was seen since the loss leads nowhere: an image of something else.
  void TakeUpLost() {
    keyframe_ = std::move(*before_loss_);
    for (std::size_t i = keyframe_.frame + 1; i < odometry_.size(); ++i) {
      if (odometry_[i].source == PoseSource::kPredicted) odometry_[i].keyframe = false;
    }
  }

  // The pose of the next frame.
  Rigid3 Predict(StampNs stamp_ns) const {
    const int index = static_cast<int>(odometry_.size());
    const auto step = expected_(index - 1, index);
    return step ? odometry_.back().world_from_left * step->Inverse()
                : PredictPose(odometry_, stamp_ns);
  }

  std::optional<Found> FindFrom(const Reference& reference, const FrameFeatures& current,
                                const Rigid3& predicted) const {
    const auto expected = expected_(reference.frame, static_cast<int>(odometry_.size()));
    const Rigid3& world_from_reference = odometry_[reference.frame].world_from_left;
    return FindMotion(reference, current, rig_,
                      expected.value_or(predicted.Inverse() * world_from_reference), options_,
                      match_by_);
  }

  bool NeedsKeyframeNow(const std::optional<Found>& found) const {
    if (!CanCarry(previous_, options_)) return false;
    if (!found) return true;  // tracking starts anew here
    return !odometry_.back().stands_still && NeedsKeyframe(*found, keyframe_, rig_, options_);
  }

  void PromotePrevious() {
    keyframe_ = previous_;
    odometry_[keyframe_.frame].keyframe = true;
  }

  const StereoRig& rig_;
  const OdometryOptions& options_;
  MatchBy match_by_;
  ExpectedMotion expected_;
  Odometry odometry_;
  Reference keyframe_, previous_;
  std::optional<Reference> before_loss_;  // the keyframe when tracking had to start anew
};

// The first frame that others can surely be posed against; where there is none, that they might be;
// else the first of all.
int FirstThatCarries(int frame_count, const FeatureSource& features, const StereoRig& rig,
                     const OdometryOptions& options) {
  for (const int enough : {kSureTimes * options.min_inliers, options.min_inliers}) {
    for (int frame = 0; frame < frame_count; ++frame) {
      if (MakeReference(frame, features(frame), rig, options).point_count >= enough) return frame;
    }
  }
  return 0;
}

// Puts the `start` frames before the tracked ones in front of them: each posed against the first
// that was tracked, else predicted as if the motion after it had gone on, backwards in time.
Odometry WithFramesBefore(int start, const FeatureSource& features, const StereoRig& rig,
                          const OdometryOptions& options, MatchBy match_by,
                          const ExpectedMotion& expected, const Odometry& tracked) {
  Odometry latest_first(tracked.rbegin(), tracked.rend());
  for (OdometryFrame& frame : latest_first) frame.reference += start;
  const Reference first = MakeReference(start, features(start), rig, options);
  for (int index = start - 1; index >= 0; --index) {
    const FrameFeatures current = features(index);
    const auto motion = expected ? expected(index, start) : std::nullopt;
    const Rigid3 predicted = motion ? *motion : PredictPose(latest_first, current.stamp_ns);
    const auto found = FindMotion(first, current, rig, predicted.Inverse(), options, match_by);
    OdometryFrame& frame = latest_first.emplace_back();
    frame.stamp_ns = current.stamp_ns;
    if (found) {
      SetPose(*found, start, Rigid3(), options, frame);
    } else {
      frame.world_from_left = predicted;
      frame.reference = index + 1;
    }
  }
  return {latest_first.rbegin(), latest_first.rend()};
}

}  // namespace

Odometry TrackFrames(int frame_count, const FeatureSource& features, const StereoRig& rig,
                     const OdometryOptions& options, MatchBy match_by,
                     const ExpectedMotion& expected) {
  if (frame_count == 0) return {};
  const int start = FirstThatCarries(frame_count, features, rig, options);
  if (start > 0) spdlog::info("frame {} is the first that others can be posed against", start);
  Tracker tracker(rig, options, match_by, CountedFrom(start, expected));
  tracker.Start(features(start));
  for (int frame = start + 1; frame < frame_count; ++frame) tracker.Add(features(frame));
  Odometry odometry = tracker.Finish();
  if (start > 0) {
    odometry = WithFramesBefore(start, features, rig, options, match_by, expected, odometry);
  }
  SetPredictionCovariances(odometry, {options.speed_change_share, options.turn_change_rad_per_s});
  return odometry;
}

}  // namespace rigmap
