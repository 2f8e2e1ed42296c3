// The synthetic rover as the stage `adjustment` gets it.
#pragma once

#include <gtest/gtest.h>

#include <numbers>

#include "adjustment/adjust.h"
#include "adjustment/calibration.h"
#include "adjustment/internal/adjusted_points.h"
#include "correspondence/tracks.h"
#include "tests/support/rover_correspondences.h"

namespace rigmap {

constexpr double kDegree = std::numbers::pi / 180.0;

using MaybePoses = std::vector<std::optional<Rigid3>>;

inline MaybePoses AllOf(const std::vector<Rigid3>& poses) { return {poses.begin(), poses.end()}; }

inline MaybePoses InverseOf(const MaybePoses& poses) {
  MaybePoses inverse;
  for (const auto& pose : poses) {
    inverse.push_back(pose ? std::optional(pose->Inverse()) : std::nullopt);
  }
  return inverse;
}

// Errors of a pose along and about the world's axes: metres, radians.
inline Vector6d ErrorOf(const Rigid3& found, const Rigid3& truth) {
  Vector6d error;
  error << found.translation - truth.translation,
      LogRotation(found.rotation * truth.rotation.conjugate());
  return error;
}

// The point of the rover that an adjusted point is, by its first observation.
inline const Eigen::Vector3d& TruePoint(const SyntheticRover& rover, const AdjustedPoint& point) {
  const PointObservation& first = point.observations.front();
  return rover.points[rover.point_of_feature[first.frame][first.feature]];
}

// Takes away all matches between frames before `frame` and from it on.
inline void CutBefore(int frame, Correspondences& correspondences) {
  std::erase_if(correspondences.pairs,
                [&](const FramePair& pair) { return pair.a < frame && pair.b >= frame; });
}

// A rover, matches up to four frames apart, and the adjustment of it.
class AdjustTest : public testing::Test {
 protected:
  void Make(const SyntheticRoverOptions& options) {
    rover_ = MakeSyntheticRover(options);
    correspondences_ = RoverCorrespondences(rover_, 4);
  }

  // 1 cm and 0.2 degrees, about every axis, at every step.
  std::vector<Rigid3> BadOdometry() { return DriftingPoses(rover_, 0.01, 0.2 * kDegree, random_); }

  Adjustment Adjust(const MaybePoses& poses, const AdjustmentOptions& options = {}) const {
    return AdjustBundle({correspondences_, rover_.rig, poses}, options);
  }

  SyntheticRover rover_;
  Correspondences correspondences_;
  SeededRandom random_;
};

}  // namespace rigmap
