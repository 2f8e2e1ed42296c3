#include "dead_reckoning/estimate_motion.h"
#include "geometry/adjoint.h"

namespace rigmap {

std::vector<VisualStep> VisualSteps(const Odometry& odometry) {
  std::vector<VisualStep> steps;
  for (int i = 0; i < static_cast<int>(odometry.size()); ++i) {
    const OdometryFrame& frame = odometry[i];
    if (frame.source != PoseSource::kOdometry || frame.bridged || frame.reference == i) continue;
    const Rigid3 frame_from_reference = OdometricStep(odometry, i, frame.reference);
    if (frame.reference < i) {
      steps.push_back({frame.reference, i, frame_from_reference, frame.step_covariance});
      continue;
    }
    // The other way round, with its covariance in the other camera's axes.
    const Rigid3 back = frame_from_reference.Inverse();
    const Matrix6d carry = Adjoint(back);
    steps.push_back({i, frame.reference, back, carry * frame.step_covariance * carry.transpose()});
  }
  return steps;
}

}  // namespace rigmap
