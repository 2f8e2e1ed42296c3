#include "adjustment/internal/drift_effect.h"

#include <algorithm>

#include "adjustment/calibration.h"
#include "adjustment/internal/calibration_border.h"

namespace rigmap {
namespace {

// As adjustments estimate it that have drifts as unknowns: 0.5 to 0.8 px on four real drives, 1.2
// and 1.4 px on two, 0.6 px on the rendered beach.
constexpr double kDriftSigmaPx = 0.7;

// Least squares of the factor between positions and those moved.
double ScaleOf(const std::vector<std::optional<Rigid3>>& left_from_world,
               const std::vector<Vector6d>& steps) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const auto& pose : left_from_world) {
    if (!pose) continue;
    mean += pose->Inverse().translation;
    ++count;
  }
  mean /= std::max(count, 1.0);
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!left_from_world[i]) continue;
    const Eigen::Vector3d arm = left_from_world[i]->Inverse().translation - mean;
    squares += arm.squaredNorm();
    products += arm.dot(steps[i].head<3>());
  }
  return squares > 0.0 ? products / squares : 0.0;
}

}  // namespace

DriftEffect EffectOfDrift(Linearisation at, const CalibrationEquations& equations,
                          RigRefinement refined, const CalibrationVector& correction,
                          const CalibrationPrior& prior, const AdjustmentOptions& options) {
  at.field = nullptr;  // held: pixels have been moved by it
  at.drift_sigma_px = kDriftSigmaPx;
  const auto solution = SolveCalibration(at);
  if (!solution) return {};
  DriftEffect effect{.poses = std::vector<Vector6d>(at.left_from_world.size(), Vector6d::Zero())};
  // The prior weighs as much as it does without drift.
  const double inflation = Inflation(equations, options);
  if (const auto better =
          MostProbable(refined, correction, solution->equations, prior, inflation)) {
    effect.calibration = better->correction - correction;
  }
  for (std::size_t i = 0; i < at.left_from_world.size(); ++i) {
    const auto& pose = at.left_from_world[i];
    if (!pose) continue;
    const Rigid3 before = pose->Inverse(),
                 after = Moved(*pose, solution->responses[i], effect.calibration).Inverse();
    effect.poses[i] << after.translation - before.translation,
        LogRotation(after.rotation * before.rotation.conjugate());
  }
  effect.scale = ScaleOf(at.left_from_world, effect.poses);
  return effect;
}

}  // namespace rigmap
