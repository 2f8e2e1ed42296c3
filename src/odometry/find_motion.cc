#include "odometry/internal/find_motion.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/statistics.h"

namespace rigmap {
namespace {

double MedianShift(const Reference& reference, const FrameFeatures& current,
                   const std::vector<FeatureMatch>& matches) {
  std::vector<double> shifts;
  shifts.reserve(matches.size());
  for (const FeatureMatch& match : matches) {
    shifts.push_back(
        (current.features[match.b].left - reference.features.features[match.a].left).norm());
  }
  return Median(std::move(shifts));
}

std::optional<Found> Solve(const Reference& reference, const FrameFeatures& current,
                           const std::vector<FeatureMatch>& matches, const StereoRig& rig,
                           const Rigid3& predicted, const OdometryOptions& options) {
  const auto seen = SightingsOf(matches, reference.points, current.features, rig);
  StereoPoseOptions pose_options;
  // A match scatters by the noise of two keypoints.
  pose_options.noise_px = pose_options.reference_noise_px =
      options.keypoint_noise_px / std::numbers::sqrt2;
  pose_options.max_sigmas = options.max_sigmas;
  pose_options.min_inliers = options.min_inliers;
  const std::array<Rigid3, 2> guesses{predicted, Rigid3()};
  const auto pose = EstimateStereoPose(seen.sightings, rig, guesses, pose_options);
  if (!pose) return std::nullopt;
  const std::vector<FeatureMatch> agreeing = seen.Agreeing(*pose);
  return Found{pose->current_from_reference,
               pose->covariance,
               pose->inlier_count,
               static_cast<int>(seen.sightings.size()),
               MedianShift(reference, current, agreeing),
               pose->metres_sigma,
               pose->offset};
}

Vector6d MotionOf(const Found& found) {
  Vector6d motion;
  motion << found.current_from_reference.translation,
      LogRotation(found.current_from_reference.rotation);
  return motion;
}

// Of what lies far a motion shows little: only near points that stay where they are tell of none.
bool StandsStill(const Found& found, const OdometryOptions& options) {
  if (found.metres_sigma > 0.0) return false;
  const Vector6d motion = MotionOf(found);
  const double squared_sigmas = motion.dot(found.covariance.ldlt().solve(motion)) / 6.0;
  return squared_sigmas < options.stand_still_sigmas * options.stand_still_sigmas;
}

}  // namespace

Reference MakeReference(int frame, FrameFeatures features, const StereoRig& rig,
                        const OdometryOptions& options) {
  Reference reference{.frame = frame, .features = std::move(features)};
  reference.points =
      TriangulateFeatures(reference.features.features, rig, options.disparity_noise_px);
  reference.point_count =
      static_cast<int>(std::count_if(reference.points.begin(), reference.points.end(),
                                     [](const auto& point) { return point.has_value(); }));
  return reference;
}

std::optional<Found> FindMotion(const Reference& reference, const FrameFeatures& current,
                                const StereoRig& rig, const Rigid3& predicted,
                                const OdometryOptions& options, MatchBy match_by) {
  if (match_by == MatchBy::kTracks) {
    return Solve(reference, current, MatchTracks(reference.features, current), rig, predicted,
                 options);
  }
  const auto near =
      MatchFeatures(reference.features, current, PredictedPixels(reference.points, predicted, rig),
                    options.search_radius_px, {});
  auto found = Solve(reference, current, near, rig, predicted, options);
  if (found && found->inliers >= kSureTimes * options.min_inliers) return found;
  const auto everywhere = MatchFeatures(reference.features, current, {});
  auto wider = Solve(reference, current, everywhere, rig, predicted, options);
  if (!found || (wider && wider->inliers > found->inliers)) return wider;
  return found;
}

void FollowReference(const Odometry& before, int i, Odometry& odometry) {
  const int reference = odometry[i].reference;
  odometry[i].world_from_left =
      odometry[reference].world_from_left * OdometricStep(before, reference, i);
}

void SetPose(const Found& found, int reference, const Rigid3& world_from_reference,
             const OdometryOptions& options, OdometryFrame& frame) {
  frame.reference = reference;
  frame.source = PoseSource::kOdometry;
  frame.inliers = found.inliers;
  frame.offset = found.offset;
  frame.step_covariance = options.shared_noise * options.shared_noise * found.covariance;
  frame.stands_still = StandsStill(found, options);
  const Eigen::Vector3d unsure = found.metres_sigma * found.current_from_reference.translation;
  frame.step_covariance.topLeftCorner<3, 3>() += unsure * unsure.transpose();
  // It may creep: what is taken for none counts.
  if (frame.stands_still) frame.step_covariance += MotionOf(found) * MotionOf(found).transpose();
  const Rigid3 motion = frame.stands_still ? Rigid3() : found.current_from_reference;
  frame.world_from_left = world_from_reference * motion.Inverse();
}

}  // namespace rigmap
