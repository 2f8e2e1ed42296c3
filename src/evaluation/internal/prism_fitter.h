// The fit of a body's path to that of a prism.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "evaluation/prism_metrics.h"

namespace rigmap {

// Heading (rad), shift (m), prism in the body (m), clock offset (s), logarithm of the scale.
using PrismParameters = Eigen::Matrix<double, 8, 1>;

class PrismFitter {
 public:
  // Poses in the time of the track: two numbers each, for the seven that are fitted.
  static constexpr std::size_t kMinInside = 4;

  // Both in order of time, the track of two positions or more.
  PrismFitter(std::span<const TumPose> world_from_body, std::span<const PrismPosition> track);

  // The best of fits from eight headings and three clock offsets, all of which leave enough poses
  // in the time of the track: those outside cost nothing, and few fit anything.
  PrismParameters Fit(bool with_scale) const;

  // Per pose; z 1 where the pose lies in the time of the track, else 0 and no difference.
  std::vector<Eigen::Vector3d> Differences(const PrismParameters& x) const;
  std::size_t CountInside(const PrismParameters& x) const;
  // On the track at a time by the poses' clock; its end outside.
  Eigen::Vector2d TrackAt(double time_s, double clock_offset_s) const;
  double SecondsOf(std::size_t pose) const { return times_s_[pose]; }

 private:
  Eigen::VectorXd Residuals(const PrismParameters& x, double expected_offset_s) const;
  double Refine(PrismParameters& x, double expected_offset_s, std::span<const int> free) const;
  void RefineClock(PrismParameters& x, double expected_offset_s, std::span<const int> free) const;
  Eigen::Vector2d PrismOf(std::size_t pose, const PrismParameters& x) const;

  std::span<const TumPose> poses_;
  std::span<const PrismPosition> track_;
  std::vector<double> times_s_, track_times_s_;  // since the track's first position
  std::size_t enough_inside_ = 0;
};

}  // namespace rigmap
