#include "trajectory/adjusted_steps.h"

#include "geometry/carried_covariance.h"

namespace rigmap {
namespace {

// About the gauge's axes.
Matrix6d OfCalibration(int reference, int frame, const Adjustment& adjustment) {
  if (adjustment.by_calibration.empty()) return Matrix6d::Zero();
  const PoseCalibration motion =
      adjustment.by_calibration[frame] -
      CarryMatrix(*adjustment.world_from_left[reference], *adjustment.world_from_left[frame]) *
          adjustment.by_calibration[reference];
  return motion * adjustment.calibration_covariance * motion.transpose();
}

}  // namespace

std::vector<std::optional<Matrix6d>> AdjustedSteps(const Odometry& odometry,
                                                   const Adjustment& adjustment) {
  std::vector<std::optional<Matrix6d>> steps(odometry.size());
  for (std::size_t i = 0; i < adjustment.link_covariances.size(); ++i) {
    const auto& of_noise = adjustment.link_covariances[i];
    if (!of_noise) continue;
    const int frame = static_cast<int>(i);
    const Matrix6d about_gauge =
        *of_noise + OfCalibration(odometry[i].reference, frame, adjustment);
    steps[i] = Turned(about_gauge, adjustment.world_from_left[i]->Inverse());
  }
  return steps;
}

}  // namespace rigmap
