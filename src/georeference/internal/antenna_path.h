// Where a rover's antenna was.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "scene/trajectory.h"

namespace rigmap {

// Positions (of the world, metres) of an antenna fixed to the left camera. Times are seconds since
// the first pose, by the poses' clock.
class AntennaPath {
 public:
  // Poses that were only predicted are passed over. Poses further apart than max_gap_s have nothing
  // between them.
  AntennaPath(const Trajectory& trajectory, const Eigen::Vector3d& antenna_in_left,
              double max_gap_s);

  bool IsEmpty() const { return poses_.empty(); }
  double SecondsOf(StampNs stamp_ns) const;

  // Nothing before the first pose, after the last and in gaps.
  std::optional<Eigen::Vector3d> PositionAt(double time_s) const;
  // The same seen from above.
  std::optional<Eigen::Vector2d> At(double time_s) const;

  // Mean velocity (m/s) over about three seconds around a time: long enough for the noise of poses
  // not to be taken for changes of speed. Zero where there is only one pose.
  Eigen::Vector2d VelocityAt(double time_s) const;

 private:
  Trajectory poses_;
  Eigen::Vector3d antenna_in_left_;
  double max_gap_s_;
};

}  // namespace rigmap
