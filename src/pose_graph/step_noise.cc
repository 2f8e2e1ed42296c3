#include "pose_graph/internal/step_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigmap {
namespace {

StepNoise NoiseOfSteps(const Trajectory& poses, double scale_sigma) {
  const std::size_t first = FirstMeasured(poses);
  StepNoise noise;
  std::size_t worst = first;
  double length_m = 0.0, length_of_worst_m = 0.0;
  for (std::size_t i = first + 1; i < poses.size(); ++i) {
    length_m +=
        (poses[i].world_from_left.translation - poses[i - 1].world_from_left.translation).norm();
    if (!poses[i].IsMeasured() ||
        poses[i].position_covariance.trace() <= poses[worst].position_covariance.trace()) {
      continue;
    }
    worst = i;
    length_of_worst_m = length_m;
  }
  if (worst == first) return noise;
  const auto steps = static_cast<double>(worst - first);
  const Vector6d& sigmas = poses[worst].sigmas;
  noise.radians = std::max(noise.radians, sigmas.tail<3>().norm() / std::sqrt(3.0 * steps));
  // What neither the common scale nor the walk of the headings explains. Each turn moves the end in
  // two directions, by its distance from it.
  const double by_scale = scale_sigma * length_of_worst_m;
  const double by_heading =
      noise.radians * std::sqrt(steps / 3.0) * length_of_worst_m * std::numbers::sqrt2;
  const double rest =
      sigmas.head<3>().squaredNorm() - by_scale * by_scale - by_heading * by_heading;
  noise.metres = std::max(noise.metres, std::sqrt(std::max(0.0, rest) / (3.0 * steps)));
  return noise;
}

}  // namespace

std::vector<StepNoise> NoisePerStep(const Trajectory& poses, double scale_sigma) {
  std::vector<StepNoise> noise(poses.size(), NoiseOfSteps(poses, scale_sigma));
  Vector6d measured = Vector6d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].IsMeasured()) {
      measured = poses[i].sigmas;
      continue;
    }
    const Vector6d more = (poses[i].sigmas.cwiseAbs2() - measured.cwiseAbs2()).cwiseMax(0.0);
    const double metres = std::sqrt(more.head<3>().mean());
    const double radians = std::sqrt(more.tail<3>().mean());
    for (const std::size_t step : {i, std::min(i + 1, poses.size() - 1)}) {
      noise[step].metres = std::max(noise[step].metres, metres);
      noise[step].radians = std::max(noise[step].radians, radians);
    }
  }
  return noise;
}

}  // namespace rigmap
