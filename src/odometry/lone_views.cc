#include "odometry/lone_views.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

#include "correspondence/sightings.h"
#include "geometry/adjoint.h"
#include "trajectory/lost_frames.h"
#include "trajectory/motion_model.h"

namespace rigmap {
namespace {

struct Motion {
  Rigid3 to_from_from;
  Matrix6d covariance = Matrix6d::Zero();  // left perturbation: translation (m), rotation (rad)
  int inliers = 0;
};

Motion Carried(const Rigid3& motion, const Motion& before) {
  const Matrix6d carry = Adjoint(motion);
  return {motion * before.to_from_from, carry * before.covariance * carry.transpose(),
          before.inliers};
}

// A stereo frame with its points.
struct PosedFrame {
  int frame = 0;
  FrameFeatures features;
  std::vector<std::optional<StereoPoint>> points;
};

class Bridger {
 public:
  Bridger(Odometry odometry, const FeatureSource& features, const LoneViewSource& views,
          const StereoRig& rig, const OdometryOptions& options)
      : before_(odometry),
        odometry_(std::move(odometry)),
        features_(features),
        views_(views),
        rig_(rig),
        options_(options) {}

  Odometry Bridge() {
    const std::vector<int> lost = LostFrames(odometry_);
    if (lost.empty()) return std::move(odometry_);
    for (int i = 1; i < static_cast<int>(odometry_.size()); ++i) {
      OdometryFrame& frame = odometry_[i];
      if (frame.reference >= i) continue;
      std::optional<Pose> pose;
      if (std::ranges::binary_search(lost, i)) pose = Find(i);
      if (pose) {
        Set(*pose, frame);
      } else {
        frame.world_from_left =
            odometry_[frame.reference].world_from_left * OdometricStep(before_, frame.reference, i);
      }
    }
    if (bridged_ > 0) {
      spdlog::info("{} frames are posed by lone images", bridged_);
      BridgePredicted(odometry_);
    }
    return std::move(odometry_);
  }

 private:
  struct Pose {
    int reference = 0;
    Motion left_from_reference;
  };

  std::optional<PosedFrame> FrameWithPoints(int i) const {
    PosedFrame frame{i, features_(i), {}};
    frame.points = TriangulateFeatures(frame.features.features, rig_, options_.disparity_noise_px);
    const auto count =
        std::ranges::count_if(frame.points, [](const auto& p) { return p.has_value(); });
    return count >= options_.min_inliers ? std::optional(std::move(frame)) : std::nullopt;
  }

  // The last before frame i that others can be posed against.
  std::optional<PosedFrame> Before(int i) const {
    for (int k = i - 1; k >= 0; --k) {
      if (auto frame = FrameWithPoints(k)) return frame;
    }
    return std::nullopt;
  }

  // view_from_frame: of the eye that the view is of.
  std::optional<Motion> MotionTo(const LoneView& view, const PosedFrame& frame) const {
    StereoRig seen = rig_;
    seen.left = rig_.Of(view.eye);
    const auto sightings = SightingsOf(MatchFeatures(frame.features, view.features, {}),
                                       frame.points, view.features.features, seen);
    StereoPoseOptions options;
    options.noise_px = options.reference_noise_px =
        options_.keypoint_noise_px / std::numbers::sqrt2;
    options.max_sigmas = options_.max_sigmas;
    options.min_inliers = options_.min_inliers;
    const std::array guesses{EyeFromLeft(view.eye)};
    const auto pose = EstimateStereoPose(sightings.sightings, seen, guesses, options);
    if (!pose) return std::nullopt;
    Motion motion{pose->current_from_reference,
                  options_.shared_noise * options_.shared_noise * pose->covariance,
                  pose->inlier_count};
    const Eigen::Vector3d unsure = pose->metres_sigma * pose->current_from_reference.translation;
    motion.covariance.topLeftCorner<3, 3>() += unsure * unsure.transpose();
    return motion;
  }

  Rigid3 EyeFromLeft(Eye eye) const { return eye == Eye::kLeft ? Rigid3() : rig_.right_from_left; }

  // Of a lost frame, against the last one before it that has points.
  std::optional<Pose> Find(int i) const {
    const auto reference = Before(i);
    if (!reference) return std::nullopt;
    const StampNs own_ns = before_[i].stamp_ns;
    const auto frame = FrameWithPoints(i);
    std::optional<Motion> best;
    for (const LoneView& view : views_(before_[reference->frame].stamp_ns, own_ns + 1)) {
      if ((view.features.stamp_ns == own_ns) == frame.has_value()) continue;
      const auto to_view = MotionTo(view, *reference);
      if (!to_view) continue;
      const auto found = frame ? Across(view, *frame, *to_view)
                               : Carried(EyeFromLeft(view.eye).Inverse(), *to_view);
      if (found && (!best || found->covariance.trace() < best->covariance.trace())) best = found;
    }
    return best ? std::optional(Pose{reference->frame, *best}) : std::nullopt;
  }

  // From the frame before the gap to the one behind, both of which see what the view shows.
  std::optional<Motion> Across(const LoneView& view, const PosedFrame& frame,
                               const Motion& view_from_reference) const {
    const auto view_from_frame = MotionTo(view, frame);
    if (!view_from_frame) return std::nullopt;
    Motion difference = view_from_reference;
    difference.covariance += view_from_frame->covariance;
    difference.inliers = std::min(difference.inliers, view_from_frame->inliers);
    return Carried(view_from_frame->to_from_from.Inverse(), difference);
  }

  void Set(const Pose& pose, OdometryFrame& frame) {
    const Motion& motion = pose.left_from_reference;
    frame.reference = pose.reference;
    frame.world_from_left =
        odometry_[pose.reference].world_from_left * motion.to_from_from.Inverse();
    frame.step_covariance = motion.covariance;
    frame.source = PoseSource::kOdometry;
    frame.inliers = motion.inliers;
    ++bridged_;
  }

  const Odometry before_;
  Odometry odometry_;
  const FeatureSource& features_;
  const LoneViewSource& views_;
  const StereoRig& rig_;
  const OdometryOptions& options_;
  int bridged_ = 0;
};

}  // namespace

Odometry BridgeByLoneViews(Odometry odometry, const FeatureSource& features,
                           const LoneViewSource& views, const StereoRig& rig,
                           const OdometryOptions& options) {
  return Bridger(std::move(odometry), features, views, rig, options).Bridge();
}

}  // namespace rigmap
