#include "odometry/searched_ground.h"

#include <spdlog/spdlog.h>

#include <array>
#include <optional>
#include <vector>

#include "correspondence/ground_warp.h"
#include "correspondence/patch_search.h"
#include "odometry/internal/find_motion.h"
#include "trajectory/motion_model.h"

namespace rigmap {
namespace {

// Features of the reference, and where the current frame may show them.
struct Expected {
  std::vector<int> features;
  std::vector<Eigen::Vector2d> pixels;
};

Expected ExpectedIn(const Reference& reference, const Rigid3& predicted, const Camera& camera) {
  Expected expected;
  for (std::size_t i = 0; i < reference.points.size(); ++i) {
    if (!reference.points[i]) continue;
    const auto pixel = Project(camera, predicted * reference.points[i]->x_in_left);
    if (!pixel || !camera.Contains(*pixel)) continue;
    expected.features.push_back(static_cast<int>(i));
    expected.pixels.push_back(*pixel);
  }
  return expected;
}

Eigen::Vector2d Rounded(const Eigen::Vector2d& pixel) {
  return {std::round(pixel.x()), std::round(pixel.y())};
}

double PositionVariance(const OdometryFrame& frame) {
  return frame.step_covariance.topLeftCorner<3, 3>().trace();
}

class GroundSearcher {
 public:
  GroundSearcher(const Odometry& odometry, const FeatureSource& features,
                 const FeatureSampler& sample, const StereoRig& rig, const OdometryOptions& options)
      : before_(odometry),
        odometry_(odometry),
        features_(features),
        sample_(sample),
        rig_(rig),
        options_(options) {}

  Odometry Bridge() {
    int bridged = 0;
    for (int i = 1; i < static_cast<int>(odometry_.size()); ++i) {
      if (odometry_[i].reference >= i) continue;
      FollowReference(before_, i, odometry_);
      const bool is_asked = odometry_[i].bridged || IsGuessed(i);
      if (is_asked && Pose(i)) ++bridged;
    }
    if (bridged > 0) {
      spdlog::info("{} frames are posed by ground that was searched", bridged);
      BridgePredicted(odometry_);
    }
    return std::move(odometry_);
  }

 private:
  bool IsGuessed(int i) const { return odometry_[i].source == PoseSource::kPredicted; }

  // What sensors know against its reference is not to hang on a guess instead.
  bool Pose(int i) {
    const int reference = odometry_[i].reference;
    const bool may_hang_on_last = IsGuessed(i) || !IsGuessed(i - 1) || reference == i - 1;
    if (may_hang_on_last && PoseAgainst(i - 1, i)) return true;
    return reference < i - 1 && PoseAgainst(reference, i);
  }

  bool PoseAgainst(int reference_frame, int i) {
    const Reference reference =
        MakeReference(reference_frame, features_(reference_frame), rig_, options_);
    if (reference.point_count < options_.min_inliers) return false;
    const Rigid3& world_from_reference = odometry_[reference_frame].world_from_left;
    const auto found =
        Search(reference, i, odometry_[i].world_from_left.Inverse() * world_from_reference);
    if (!found) return false;
    OdometryFrame posed = odometry_[i];
    posed.bridged = false;
    SetPose(*found, reference_frame, world_from_reference, options_, posed);
    const bool same_step = odometry_[i].bridged && odometry_[i].reference == reference_frame;
    if (same_step && !posed.stands_still && Combine(world_from_reference, odometry_[i], posed)) {
      odometry_[i] = posed;
      return true;
    }
    if (odometry_[i].bridged && PositionVariance(posed) >= PositionVariance(odometry_[i])) {
      return false;
    }
    odometry_[i] = posed;
    return true;
  }

  // Of one step as sensors and as images know it, the mean of both, by their covariances. False,
  // with nothing changed, where they contradict each other.
  bool Combine(const Rigid3& world_from_reference, const OdometryFrame& by_sensors,
               OdometryFrame& by_images) const {
    const Matrix6d &of_sensors = by_sensors.step_covariance, &of_images = by_images.step_covariance;
    const Rigid3 apart = by_images.world_from_left.Inverse() * by_sensors.world_from_left;
    Vector6d towards_images;
    towards_images << apart.translation, LogRotation(apart.rotation);
    const auto both = (of_sensors + of_images).ldlt();
    const double squares = towards_images.dot(both.solve(towards_images));
    if (!(squares <= options_.max_sigmas * options_.max_sigmas)) return false;
    const Matrix6d share = both.solve(of_sensors).transpose();  // of the images
    const Vector6d moved = share * towards_images;
    const Rigid3 left_from_reference =
        Rigid3{ExpRotation(moved.tail<3>()), moved.head<3>()} *
        (by_sensors.world_from_left.Inverse() * world_from_reference);
    by_images.world_from_left = world_from_reference * left_from_reference.Inverse();
    by_images.step_covariance = of_sensors - share * of_sensors;
    by_images.offset.lengthening_m_per_px *= share.topLeftCorner<3, 3>().trace() / 3.0;
    return true;
  }

  std::optional<Found> Search(const Reference& reference, int current,
                              const Rigid3& predicted) const {
    const Expected expected = ExpectedIn(reference, predicted, rig_.left.camera);
    if (static_cast<int>(expected.features.size()) < options_.min_inliers) return std::nullopt;
    const auto sampled = sample_(current, expected.pixels);
    FrameFeatures seen;
    std::vector<FeatureMatch> matches;
    for (std::size_t k = 0; k < sampled.size(); ++k) {
      if (!sampled[k]) continue;
      const int feature = expected.features[k];
      const auto offset = FindInPatch(PatchOf(reference, feature, predicted), sampled[k]->patch);
      if (!offset) continue;
      matches.push_back({feature, static_cast<int>(seen.features.size())});
      seen.features.push_back({.left = Rounded(sampled[k]->feature.left) + *offset});
    }
    return MotionOf(reference, seen, matches, predicted);
  }

  SearchedPatch PatchOf(const Reference& reference, int feature, const Rigid3& predicted) const {
    const auto& features = reference.features.features;
    const Eigen::Vector2d& pixel = features[feature].left;
    SearchedPatch searched{reference.features.patches[feature], pixel - Rounded(pixel)};
    const auto ground = GroundAround(features, reference.points, feature, reference.frame);
    const auto warp = ground ? GroundWarp(*ground, predicted, rig_.left.camera) : std::nullopt;
    if (warp) searched.searched_from_patch = warp->linear;
    return searched;
  }

  std::optional<Found> MotionOf(const Reference& reference, const FrameFeatures& seen,
                                const std::vector<FeatureMatch>& matches,
                                const Rigid3& predicted) const {
    StereoPoseOptions pose_options;
    pose_options.noise_px = kNoise_px;
    pose_options.max_sigmas = options_.max_sigmas;
    pose_options.min_inliers = options_.min_inliers;
    const auto sightings = SightingsOf(matches, reference.points, seen.features, rig_);
    const auto pose =
        EstimateStereoPose(sightings.sightings, rig_, std::array{predicted}, pose_options);
    if (!pose || 2 * pose->inlier_count <= static_cast<int>(sightings.sightings.size())) {
      return std::nullopt;
    }
    return Found{.current_from_reference = pose->current_from_reference,
                 .covariance = pose->covariance,
                 .inliers = pose->inlier_count,
                 .matches = static_cast<int>(sightings.sightings.size()),
                 .metres_sigma = pose->metres_sigma,
                 .offset = pose->offset};
  }

  // Of a peak of correlation: on flat sand 0.3 to 0.5 px are left to the motion that they agree on.
  static constexpr double kNoise_px = 0.5;

  const Odometry& before_;
  Odometry odometry_;
  const FeatureSource& features_;
  const FeatureSampler& sample_;
  const StereoRig& rig_;
  const OdometryOptions& options_;
};

}  // namespace

Odometry BridgeBySearch(Odometry odometry, const FeatureSource& features,
                        const FeatureSampler& sample, const StereoRig& rig,
                        const OdometryOptions& options) {
  return GroundSearcher(odometry, features, sample, rig, options).Bridge();
}

}  // namespace rigmap
