#include "pose_graph/internal/step_noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/statistics.h"

namespace rigmap {
namespace {

// The measured pose that is known least.
std::size_t WorstMeasured(const Trajectory& poses) {
  std::size_t worst = FirstMeasured(poses);
  for (std::size_t i = worst + 1; i < poses.size(); ++i) {
    if (poses[i].IsMeasured() &&
        poses[i].position_covariance.trace() > poses[worst].position_covariance.trace()) {
      worst = i;
    }
  }
  return worst;
}

// Variances per axis of each step, positions or turns.
using Variances = std::vector<double>;

// Of what guesses add to what was measured before them; 0 for other steps.
struct OfGuesses {
  Variances metres, radians;
};

OfGuesses VariancesOfGuesses(const Trajectory& poses) {
  OfGuesses guesses{Variances(poses.size(), 0.0), Variances(poses.size(), 0.0)};
  Vector6d measured = Vector6d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].IsMeasured()) {
      measured = poses[i].sigmas;
      continue;
    }
    const Vector6d more = (poses[i].sigmas.cwiseAbs2() - measured.cwiseAbs2()).cwiseMax(0.0);
    for (const std::size_t step : {i, std::min(i + 1, poses.size() - 1)}) {
      guesses.metres[step] = std::max(guesses.metres[step], more.head<3>().mean());
      guesses.radians[step] = std::max(guesses.radians[step], more.tail<3>().mean());
    }
  }
  return guesses;
}

// What steps are known by, one against the other: `of_step` where something is known of it, else as
// the median of those, of guesses nothing.
template <class OfStep>
Variances Weights(const StepCovariances& known, const Variances& of_guesses,
                  const OfStep& of_step) {
  Variances weights(of_guesses.size(), 0.0), all;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i] || of_guesses[i] > 0.0) continue;
    weights[i] = of_step(*known[i]);
    all.push_back(weights[i]);
  }
  const double usual = all.empty() ? 1.0 : Median(std::move(all));
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const bool is_known = i < known.size() && known[i];
    if (!is_known && of_guesses[i] == 0.0) weights[i] = usual;
  }
  return weights;
}

// The steps (first, worst] share `variance`, less what is of guesses, by their weights.
Variances Spread(double variance, std::size_t first, std::size_t worst, const Variances& weights,
                 const Variances& of_guesses) {
  const auto sum = [&](const Variances& values) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                           values.begin() + static_cast<std::ptrdiff_t>(worst) + 1, 0.0);
  };
  const double all = sum(weights);
  const double of_unit = all > 0.0 ? std::max(0.0, variance - sum(of_guesses)) / all : 0.0;
  Variances spread = of_guesses;
  for (std::size_t i = 0; i < spread.size(); ++i) {
    spread[i] = std::max(spread[i], of_unit * weights[i]);
  }
  return spread;
}

// The square of what the scale and the walk of the headings explain of the worst pose's position,
// all axes together. Each turn moves the end in two directions, by its distance from it.
double ExplainedSquare(const Trajectory& poses, std::size_t first, std::size_t worst,
                       const Variances& radians, double scale_sigma) {
  const auto to_worst_m = [&](std::size_t i) {
    return (poses[worst].world_from_left.translation - poses[i].world_from_left.translation).norm();
  };
  double square = std::pow(scale_sigma * to_worst_m(first), 2);
  for (std::size_t i = first + 1; i <= worst; ++i)
    square += 2.0 * radians[i] * std::pow(to_worst_m(i), 2);
  return square;
}

}  // namespace

std::vector<StepNoise> NoisePerStep(const Trajectory& poses, const StepCovariances& known,
                                    double scale_sigma) {
  const std::size_t first = FirstMeasured(poses), worst = WorstMeasured(poses);
  const OfGuesses guesses = VariancesOfGuesses(poses);
  const Variances turn_weights = Weights(known, guesses.radians, [](const Matrix6d& covariance) {
    return covariance.diagonal().tail<3>().mean();
  });
  const Variances weights = Weights(known, guesses.metres, [](const Matrix6d& covariance) {
    return covariance.diagonal().head<3>().mean();
  });
  const Vector6d squares = poses[worst].sigmas.cwiseAbs2();
  const Variances radians =
      Spread(squares.tail<3>().mean(), first, worst, turn_weights, guesses.radians);
  const double explained = ExplainedSquare(poses, first, worst, radians, scale_sigma);
  const Variances metres =
      Spread((squares.head<3>().sum() - explained) / 3.0, first, worst, weights, guesses.metres);
  std::vector<StepNoise> noise(poses.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i].metres = std::max(noise[i].metres, std::sqrt(metres[i]));
    noise[i].radians = std::max(noise[i].radians, std::sqrt(radians[i]));
  }
  return noise;
}

}  // namespace rigmap
