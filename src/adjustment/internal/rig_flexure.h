// How a rig that gives on the way turns its right eye from frame to frame. Of this room only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "adjustment/internal/calibration_blocks.h"
#include "adjustment/internal/reduced_system.h"

namespace rigmap {

// Turns of the right eye about its own axes (rad), one per frame, under a prior that keeps each of
// them near zero: what a rough road shakes. Unknowns of the adjustment beside the poses.
class RigFlexure {
 public:
  bool IsFound() const { return !turns_.empty(); }
  // Per frame; empty while there are none.
  const std::vector<Eigen::Vector3d>& Turns() const { return turns_; }
  // Of the prior, about each axis (1/rad^2), in units of what a frame's observations say of its
  // turn as independent ones would: what they are off by together, the turn itself takes up.
  const Eigen::Vector3d& Information() const { return information_; }
  // Of the turns that were found (rad); zero about axes about which there are none.
  const Eigen::Vector3d& Sigmas() const { return sigmas_; }

  // Where the right eye would see without its turn what it sees at this pixel in this frame; the
  // pixel itself where that has no ray.
  Eigen::Vector2d Steadied(const Camera& right, int frame, const Eigen::Vector2d& pixel) const;

  // True, with turns that are still zero, where what two halves of each frame's points ask for
  // agrees over the frames, by more than chance and by more than what `shared_noise` stands for.
  // What they have in common are the prior's sigmas.
  bool Begin(const Linearisation& at, const AdjustmentOptions& options);

  void Move(const std::vector<PoseResponse>& responses, const CalibrationVector& calibration_step);
  // Of a step, the largest turn of any frame (rad).
  static double LargestStep(const std::vector<PoseResponse>& responses,
                            const CalibrationVector& calibration_step);

 private:
  std::vector<Eigen::Vector3d> turns_;
  Eigen::Vector3d sigmas_ = Eigen::Vector3d::Zero(), information_ = Eigen::Vector3d::Zero();
};

}  // namespace rigmap
