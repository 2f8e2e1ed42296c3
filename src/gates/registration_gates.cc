#include "gates/registration_gates.h"

#include <algorithm>

#include "core/statistics.h"

namespace rigmap {
namespace {

std::optional<double> UnheldShare(const Registration& registration) {
  if (registration.frames.empty()) return std::nullopt;
  const auto unheld = std::ranges::count(registration.frames, false, &RegisteredFrame::held);
  return static_cast<double>(unheld) / static_cast<double>(registration.frames.size());
}

struct Closures {
  std::vector<double> pct, sigmas;  // of the way, of each frame that was registered twice
};

Closures ClosuresOf(const Registration& registration) {
  Closures closures;
  for (std::size_t i = 2; i < registration.frames.size(); ++i) {
    const RegisteredFrame& frame = registration.frames[i];
    if (!frame.closure_m || !frame.closure_sigmas) continue;
    const auto position = [&](std::size_t at) -> const Eigen::Vector3d& {
      return registration.motion[at].world_from_left.translation;
    };
    const double way_m =
        (position(i) - position(i - 1)).norm() + (position(i - 1) - position(i - 2)).norm();
    closures.pct.push_back(100.0 * *frame.closure_m / std::max(way_m, registration.grid_m));
    closures.sigmas.push_back(*frame.closure_sigmas);
  }
  return closures;
}

std::optional<double> Typical(std::vector<double> values) {
  constexpr double kShare = 0.9;
  if (values.empty()) return std::nullopt;
  return Quantile(std::move(values), kShare);
}

}  // namespace

Gates JudgeRegistration(const Registration& registration, const RegistrationGateOptions& options) {
  const Closures closures = ClosuresOf(registration);
  Gates gates{AtMost("unheld", UnheldShare(registration), options.unheld,
                     "share of frames whose cloud the surface does not hold")};
  AddEither(AtMost("closure_sigmas", Typical(closures.sigmas), options.closure_sigmas,
                   "chained against direct registration, 90th percentile, in sigmas"),
            AtMost("closure_pct", Typical(closures.pct), options.closure_pct,
                   "chained against direct registration, 90th percentile, per cent of the way"),
            gates);
  return gates;
}

Odometry WithNoiseOf(const Registration& registration, Odometry odometry) {
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    OdometryFrame& step = odometry[i];
    const OdometryFrame &to = registration.motion[i], &from = registration.motion[step.reference];
    if (step.source != PoseSource::kOdometry) continue;
    step.step_covariance += to.step_covariance;
    // Both hang on other frames, but where the one hangs on the other.
    if (to.reference != step.reference) step.step_covariance += from.step_covariance;
  }
  return odometry;
}

Adjustment AsAdjustment(const Registration& registration) {
  Adjustment poses;
  const std::size_t count = registration.motion.size();
  poses.world_from_left.resize(count);
  const auto first =
      std::ranges::find(registration.motion, PoseSource::kOdometry, &OdometryFrame::source);
  const int datum = static_cast<int>(first - registration.motion.begin());
  poses.datum_frames.assign(count, datum);
  for (std::size_t i = 0; i < count; ++i) {
    const OdometryFrame& frame = registration.motion[i];
    if (frame.source == PoseSource::kOdometry) poses.world_from_left[i] = frame.world_from_left;
  }
  return poses;
}

}  // namespace rigmap
