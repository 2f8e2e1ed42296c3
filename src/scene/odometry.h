// What stereo odometry knows of a part: a pose for every frame, each hanging on a keyframe.
#pragma once

#include <vector>

#include "scene/offset_effect.h"
#include "scene/trajectory.h"

namespace rigmap {

struct OdometryFrame {
  StampNs stamp_ns = 0;
  // Metres; world = left camera axes of the first frame that shows enough to pose others against.
  Rigid3 world_from_left;
  // The frame whose stereo points this one was posed against (its own index for the first posed
  // one); of a predicted frame the frame before it, or the one after it if it lies before the first
  // posed one.
  int reference = 0;
  // Of left_from_reference's motion, as a left perturbation: translation (m), rotation (rad).
  Matrix6d step_covariance = Matrix6d::Zero();
  PoseSource source = PoseSource::kPredicted;
  bool keyframe = false;
  bool stands_still = false;  // no motion against its reference
  bool bridged = false;       // posed against it by the rover's sensors, not by images
  int inliers = 0;
  OffsetEffect offset;  // on left_from_reference's motion; none where no points say it

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stamp_ns, world_from_left, reference, step_covariance, source, keyframe, stands_still,
            bridged, inliers, offset);
  }
};

using Odometry = std::vector<OdometryFrame>;

// left_from_left: the pose of frame `to` in the left camera of frame `from`.
inline Rigid3 OdometricStep(const Odometry& odometry, int from, int to) {
  return odometry[from].world_from_left.Inverse() * odometry[to].world_from_left;
}

}  // namespace rigmap
