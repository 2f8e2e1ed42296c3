// The motion from one stereo frame to another.
#pragma once

#include <optional>
#include <vector>

#include "correspondence/sightings.h"
#include "odometry/track_frames.h"

namespace rigmap {

// Some times the fewest inliers that make a motion are enough to be sure of it.
inline constexpr int kSureTimes = 3;

// A frame with what is needed to pose others against it.
struct Reference {
  int frame = 0;
  FrameFeatures features;
  std::vector<std::optional<StereoPoint>> points;
  int point_count = 0;
};

// A motion found between a reference and the current frame.
struct Found {
  Rigid3 current_from_reference;
  Matrix6d covariance = Matrix6d::Zero();
  int inliers = 0;
  int matches = 0;               // that could have agreed
  double median_shift_px = 0.0;  // of the inliers' left pixels
  double metres_sigma = 0.0;     // as a share of its length, beyond its covariance
  OffsetEffect offset;
};

Reference MakeReference(int frame, FrameFeatures features, const StereoRig& rig,
                        const OdometryOptions& options);

// Nothing where too few matches agree on one. `predicted`: current from reference. Descriptors are
// looked for near the prediction first; everywhere when that finds too few to be sure of.
std::optional<Found> FindMotion(const Reference& reference, const FrameFeatures& current,
                                const StereoRig& rig, const Rigid3& predicted,
                                const OdometryOptions& options, MatchBy match_by);

// Moves frame i as its reference was moved since `before`.
void FollowReference(const Odometry& before, int i, Odometry& odometry);

// Fills the frame's pose and what is known of it, from its motion against a reference.
void SetPose(const Found& found, int reference, const Rigid3& world_from_reference,
             const OdometryOptions& options, OdometryFrame& frame);

}  // namespace rigmap
