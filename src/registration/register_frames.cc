#include "registration/register_frames.h"

#include <pcl/console/print.h>
#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>

#include "core/statistics.h"
#include "geometry/adjoint.h"
#include "registration/internal/chained_way.h"
#include "registration/internal/cloud_alignment.h"

namespace rigmap {
namespace {

struct PosedCloud {
  int frame = 0;
  FrameCloud cloud;
};

class Chain {
 public:
  Chain(const Odometry& odometry, const StereoRig& rig, double grid_m,
        const RegistrationOptions& options)
      : odometry_(odometry),
        metres_px_(rig.left.camera.MeanFocal() * rig.Baseline()),
        grid_m_(grid_m),
        options_(options) {}

  void Add(int frame, FrameCloud cloud) {
    OdometryFrame entry{.stamp_ns = odometry_[frame].stamp_ns};
    RegisteredFrame found;
    entry.reference = std::max(0, frame - 1);
    if (frame > 0) entry.world_from_left = Guess(frame);
    if (map_.empty()) {
      // The first cloud is the datum: all others hang on it.
      if (!cloud.empty()) {
        entry = {.stamp_ns = entry.stamp_ns,
                 .world_from_left = entry.world_from_left,
                 .reference = frame,
                 .source = PoseSource::kOdometry,
                 .keyframe = true};
        found.converged = found.held = true;
        found.overlap = 1.0;
      }
    } else if (!cloud.empty()) {
      Register(frame, cloud, entry, found);
    }
    registration_.motion.push_back(entry);
    if (entry.source == PoseSource::kOdometry) {
      Close(frame, cloud, found);
      if (entry.keyframe) map_.push_back({frame, cloud});
      if (map_.size() > static_cast<std::size_t>(options_.map_keyframes)) map_.pop_front();
      recent_.push_back({frame, std::move(cloud)});
      if (recent_.size() > 2) recent_.pop_front();
    }
    registration_.frames.push_back(found);
  }

  Registration Take() {
    registration_.grid_m = grid_m_;
    return std::move(registration_);
  }

 private:
  bool Holds(const CloudAlignment& aligned) const {
    return aligned.converged && aligned.held && aligned.overlap >= options_.min_overlap;
  }

  const Rigid3& PoseOf(int frame) const { return registration_.motion[frame].world_from_left; }

  Rigid3 Guess(int frame) const {
    const Rigid3& before = PoseOf(frame - 1);
    if (options_.first_guess == FirstGuess::kNone) return before;
    const bool is_measured = odometry_[frame].source == PoseSource::kOdometry;
    if (options_.first_guess != FirstGuess::kPreviousMotion && is_measured) {
      return before * OdometricStep(odometry_, frame - 1, frame);
    }
    return PredictPose(registration_.motion, odometry_[frame].stamp_ns);
  }

  // The clouds of the last keyframes in the axes of the last.
  PclCloud::Ptr LocalMap() const {
    auto all = std::make_shared<PclCloud>();
    const Rigid3 last_from_world = PoseOf(map_.back().frame).Inverse();
    for (const PosedCloud& keyframe : map_) {
      AppendMoved(keyframe.cloud, last_from_world * PoseOf(keyframe.frame), *all);
    }
    return all;
  }

  void Register(int frame, const FrameCloud& cloud, OdometryFrame& entry, RegisteredFrame& found) {
    const int reference = map_.back().frame;
    const Rigid3& world_from_reference = PoseOf(reference);
    const CloudAlignment aligned =
        Align(ToPcl(cloud), LocalMap(), world_from_reference.Inverse() * entry.world_from_left,
              grid_m_, options_);
    found.converged = aligned.converged;
    found.held = aligned.held;
    found.overlap = aligned.overlap;
    found.rms_m = aligned.rms_m;
    const bool chains_anything = options_.way == RegistrationWay::kPlain;
    if (!aligned.converged || aligned.overlap < options_.min_overlap ||
        !(aligned.held || chains_anything)) {
      spdlog::info("frame {}: not registered: {}, {}, overlap {:.2f}", frame,
                   aligned.converged ? "converged" : "not converged",
                   aligned.held ? "held" : "not held by the surface", aligned.overlap);
      return;
    }
    entry.reference = reference;
    entry.world_from_left = world_from_reference * aligned.target_from_source;
    entry.source = PoseSource::kOdometry;
    entry.keyframe =
        options_.keyframe_overlap == 1.0 || aligned.overlap < options_.keyframe_overlap;
    entry.step_covariance = CovarianceInSource(aligned);
    // What the images say of an offset they say of the clouds' depths, too.
    entry.offset = odometry_[frame].offset;
    entry.offset.lengthening_m_per_px = aligned.lengthening_m / metres_px_;
  }

  // Of source_from_target, the inverse of what was found, as a left perturbation.
  Matrix6d CovarianceInSource(const CloudAlignment& aligned) const {
    const Rigid3 source_from_target = aligned.target_from_source.Inverse();
    const Matrix6d adjoint = Adjoint(source_from_target);
    return options_.shared_noise * options_.shared_noise * adjoint * aligned.covariance *
           adjoint.transpose();
  }

  // Against the frame before the last.
  void Close(int frame, const FrameCloud& cloud, RegisteredFrame& found) const {
    if (recent_.size() < 2) return;
    const PosedCloud& other = recent_.front();
    const Rigid3 chained = PoseOf(other.frame).Inverse() * PoseOf(frame);
    const CloudAlignment aligned =
        Align(ToPcl(cloud), ToPcl(other.cloud), chained, grid_m_, options_);
    if (!Holds(aligned)) return;
    const Rigid3 off = chained.Inverse() * aligned.target_from_source;
    found.closure_m = off.translation.norm();
    // Both ways there are uncertain.
    const auto chained_covariance = CovarianceBetween(registration_.motion, other.frame, frame);
    if (!chained_covariance) return;
    const Matrix6d covariance = CovarianceInSource(aligned) + *chained_covariance;
    Vector6d difference;
    difference << off.translation, LogRotation(off.rotation);
    found.closure_sigmas = RootOfSquares(difference.dot(covariance.ldlt().solve(difference)) / 6.0);
  }

  const Odometry& odometry_;
  double metres_px_;  // depth times disparity
  double grid_m_;
  const RegistrationOptions& options_;
  std::deque<PosedCloud> map_;     // keyframes
  std::deque<PosedCloud> recent_;  // the last two registered frames
  Registration registration_;
};

// Of predicted steps, and of those in which nothing held the cloud.
void SetGuessedCovariances(const UnmeasuredMotion& unmeasured, Registration& registration) {
  Odometry motion = registration.motion;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (!registration.frames[i].held) motion[i].source = PoseSource::kPredicted;
  }
  SetPredictionCovariances(motion, unmeasured);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    registration.motion[i].step_covariance = motion[i].step_covariance;
  }
}

}  // namespace

Registration RegisterFrames(const CloudSource& clouds, const Odometry& odometry,
                            const StereoRig& rig, double grid_m, const RegistrationOptions& asked,
                            const UnmeasuredMotion& unmeasured) {
  RequireValid(asked);
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // its messages are for its users
  const RegistrationOptions options = Resolved(asked);
  Chain chain(odometry, rig, grid_m, options);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    chain.Add(static_cast<int>(i), clouds(static_cast<int>(i)));
  }
  Registration registration = chain.Take();
  SetGuessedCovariances(unmeasured, registration);
  return registration;
}

}  // namespace rigmap
