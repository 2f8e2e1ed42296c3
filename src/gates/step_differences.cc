#include "gates/internal/step_differences.h"

#include "core/statistics.h"

namespace rigmap {

MotionDifference DifferenceOf(const Rigid3& motion, const Rigid3& measured,
                              const Matrix6d& covariance) {
  const Rigid3 off = motion * measured.Inverse();
  Vector6d difference;
  difference << off.translation, LogRotation(off.rotation);
  const double squares = difference.dot(covariance.ldlt().solve(difference)) / 6.0;
  return {RootOfSquares(squares), RootOfSquares(off.translation.squaredNorm())};
}

std::vector<StepDifference> StepDifferences(const GateInputs& inputs) {
  std::vector<StepDifference> differences;
  for (std::size_t i = 0; i < inputs.odometry.size(); ++i) {
    const OdometryFrame& frame = inputs.odometry[i];
    const auto reference = static_cast<std::size_t>(frame.reference);
    const auto &to = inputs.adjustment.world_from_left[i],
               &from = inputs.adjustment.world_from_left[reference];
    if (frame.source != PoseSource::kOdometry || reference == i || !to || !from) continue;
    const Rigid3 odometric =
        frame.world_from_left.Inverse() * inputs.odometry[reference].world_from_left;
    const MotionDifference off =
        DifferenceOf(to->Inverse() * *from, odometric, frame.step_covariance);
    const double step_m = odometric.translation.norm();
    differences.push_back(
        {static_cast<int>(i), off.sigmas, step_m > 0.0 ? 100.0 * off.distance_m / step_m : 0.0});
  }
  return differences;
}

}  // namespace rigmap
