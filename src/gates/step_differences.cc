#include "gates/internal/step_differences.h"

#include "core/statistics.h"

namespace rigmap {

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
    const Rigid3 off = (to->Inverse() * *from) * odometric.Inverse();
    Vector6d difference;
    difference << off.translation, LogRotation(off.rotation);
    const double squares = difference.dot(frame.step_covariance.ldlt().solve(difference)) / 6.0;
    const double off_m = RootOfSquares(off.translation.squaredNorm()),
                 step_m = odometric.translation.norm();
    differences.push_back(
        {static_cast<int>(i), RootOfSquares(squares), step_m > 0.0 ? 100.0 * off_m / step_m : 0.0});
  }
  return differences;
}

}  // namespace rigmap
