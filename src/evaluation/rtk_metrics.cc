#include "evaluation/rtk_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/statistics.h"
#include "evaluation/internal/rounded.h"

namespace rigmap {
namespace {

constexpr std::size_t kMinPairs = 4;
constexpr std::array kSegments_m{5.0, 10.0, 25.0, 50.0, 100.0};

double RootMean(double sum, double count) { return std::sqrt(sum / count); }

// Error of each pair (estimate less fix, in enu, the mean height taken off), and how far along the
// way it lies.
struct FixErrors {
  std::vector<Eigen::Vector3d> errors_m;
  std::vector<double> along_m;
};

FixErrors ErrorsOf(std::span<const FixPair> pairs, const Rigid2& plane_from_world) {
  FixErrors result;
  double mean_m = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const FixPair& pair = pairs[i];
    Eigen::Vector3d error;
    error << plane_from_world * pair.antenna_in_world.head<2>() - pair.fix_in_enu.head<2>(),
        pair.antenna_in_world.z() - pair.fix_in_enu.z();
    mean_m += error.z() / static_cast<double>(pairs.size());
    result.errors_m.push_back(error);
    const double step_m =
        i == 0 ? 0.0 : (pair.fix_in_enu - pairs[i - 1].fix_in_enu).head<2>().norm();
    result.along_m.push_back(i == 0 ? 0.0 : result.along_m.back() + step_m);
  }
  for (Eigen::Vector3d& error : result.errors_m) error.z() -= mean_m;
  return result;
}

Eigen::Vector3d MeanVariance(std::span<const FixPair> pairs) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const FixPair& pair : pairs) sum += pair.sigma_m.cwiseAbs2();
  return sum / static_cast<double>(pairs.size());
}

// Motion and clock took up so many of the horizontal residuals, the mean one of the heights.
void MeasureResiduals(const FixErrors& found, std::span<const FixPair> pairs, int fitted,
                      RtkMetrics& metrics) {
  const auto count = static_cast<double>(pairs.size());
  const Eigen::Vector3d variance = MeanVariance(pairs);
  double horizontal = 0.0, height = 0.0;
  std::vector<double> distances_m, heights_m;
  for (const Eigen::Vector3d& error : found.errors_m) {
    horizontal += error.head<2>().squaredNorm();
    height += error.z() * error.z();
    distances_m.push_back(error.head<2>().norm());
    heights_m.push_back(std::abs(error.z()));
  }
  metrics.ce90_m = InterpolatedQuantile(distances_m, 0.9);
  metrics.le90_m = InterpolatedQuantile(heights_m, 0.9);
  metrics.horizontal_rms_m = {
      RootMean(horizontal, count),
      std::sqrt(variance.head<2>().sum() * std::max(0.0, 1.0 - 0.5 * fitted / count))};
  metrics.height_rms_m = {RootMean(height, count), std::sqrt(variance.z() * (1.0 - 1.0 / count))};
}

void MeasureHeightDrift(const FixErrors& found, double height_sigma_m, RtkMetrics& metrics) {
  const auto count = static_cast<double>(found.along_m.size());
  double mean_m = 0.0, together = 0.0, squares = 0.0;
  for (const double along_m : found.along_m) mean_m += along_m / count;
  for (std::size_t i = 0; i < found.along_m.size(); ++i) {
    const double along_m = found.along_m[i] - mean_m;
    together += along_m * found.errors_m[i].z();
    squares += along_m * along_m;
  }
  if (!(squares > 0.0)) return;
  metrics.height_drift_pct = 100.0 * together / squares;
  metrics.height_drift_noise_pct = 100.0 * height_sigma_m / std::sqrt(squares);
}

// The factor of the similarity that lays the path on the fixes, for small angles between them:
// products of both about their means, over the squares of the estimate.
std::optional<JudgedFigure> MeasureScale(std::span<const FixPair> pairs, const Rigid2& motion) {
  const auto count = static_cast<double>(pairs.size());
  Eigen::Vector2d from_mean = Eigen::Vector2d::Zero(), to_mean = Eigen::Vector2d::Zero();
  for (const FixPair& pair : pairs) {
    from_mean += motion * pair.antenna_in_world.head<2>() / count;
    to_mean += pair.fix_in_enu.head<2>() / count;
  }
  double along = 0.0, across = 0.0, squares = 0.0;
  for (const FixPair& pair : pairs) {
    const Eigen::Vector2d from = motion * pair.antenna_in_world.head<2>() - from_mean;
    const Eigen::Vector2d to = pair.fix_in_enu.head<2>() - to_mean;
    along += from.dot(to);
    across += from.x() * to.y() - from.y() * to.x();
    squares += from.squaredNorm();
  }
  if (!(squares > 0.0)) return std::nullopt;
  const double sigma_m = std::sqrt(0.5 * MeanVariance(pairs).head<2>().sum());
  return JudgedFigure{std::hypot(along, across) / squares, sigma_m / std::sqrt(squares)};
}

std::optional<RtkDrift> MeasureDrift(const FixErrors& found, std::span<const FixPair> pairs,
                                     double segment_m) {
  RtkDrift drift{.segment_m = segment_m};
  double horizontal = 0.0, horizontal_noise = 0.0, height = 0.0, height_noise = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto end = std::ranges::lower_bound(found.along_m, found.along_m[i] + segment_m);
    if (end == found.along_m.end()) break;
    const auto j = static_cast<std::size_t>(end - found.along_m.begin());
    const double length_m = *end - found.along_m[i];
    const Eigen::Vector3d error = (found.errors_m[j] - found.errors_m[i]) / length_m;
    const Eigen::Vector3d variance =
        (pairs[i].sigma_m.cwiseAbs2() + pairs[j].sigma_m.cwiseAbs2()) / (length_m * length_m);
    horizontal += error.head<2>().squaredNorm();
    horizontal_noise += variance.head<2>().sum();
    height += error.z() * error.z();
    height_noise += variance.z();
    ++drift.count;
  }
  if (drift.count == 0) return std::nullopt;
  drift.horizontal_pct = {100.0 * RootMean(horizontal, drift.count),
                          100.0 * RootMean(horizontal_noise, drift.count)};
  drift.height_pct = {100.0 * RootMean(height, drift.count),
                      100.0 * RootMean(height_noise, drift.count)};
  return drift;
}

}  // namespace

std::optional<RtkMetrics> CompareRtk(std::span<const FixPair> pairs,
                                     const RtkAlignment& alignment) {
  if (pairs.size() < kMinPairs) return std::nullopt;
  const FixErrors found = ErrorsOf(pairs, alignment.plane_from_world);
  RtkMetrics metrics{.fixes = static_cast<int>(pairs.size()), .path_m = found.along_m.back()};
  MeasureResiduals(found, pairs, alignment.clock_offset_sigma_s ? 4 : 3, metrics);
  MeasureHeightDrift(found, std::sqrt(MeanVariance(pairs).z()), metrics);
  metrics.scale = MeasureScale(pairs, alignment.plane_from_world);
  for (const double segment_m : kSegments_m) {
    if (const auto drift = MeasureDrift(found, pairs, segment_m)) metrics.drift.push_back(*drift);
  }
  return metrics;
}

nlohmann::ordered_json ToJson(const RtkMetrics& metrics) {
  const auto& [horizontal_m, noise_m] = metrics.horizontal_rms_m;
  nlohmann::ordered_json json;
  json["path_m"] = Rounded(metrics.path_m, 3);
  json["noise_m"] = Rounded(noise_m, 4);
  if (metrics.path_m > 0.0) {
    json["rms_pct"] = Rounded(100.0 * horizontal_m / metrics.path_m, 4);
    json["noise_pct"] = Rounded(100.0 * noise_m / metrics.path_m, 4);
  }
  json["height_rms_m"] = Rounded(metrics.height_rms_m.value, 4);
  json["height_noise_m"] = Rounded(metrics.height_rms_m.noise, 4);
  json["ce90_m"] = Rounded(metrics.ce90_m, 4);
  json["le90_m"] = Rounded(metrics.le90_m, 4);
  json["height_drift_pct"] = Rounded(metrics.height_drift_pct, 4);
  json["height_drift_noise_pct"] = Rounded(metrics.height_drift_noise_pct, 4);
  if (metrics.scale) {
    json["scale"] = Rounded(metrics.scale->value, 5);
    json["scale_noise"] = Rounded(metrics.scale->noise, 5);
    json["scale_error_pct"] = Rounded(100.0 * std::abs(metrics.scale->value - 1.0), 3);
  }
  for (const RtkDrift& drift : metrics.drift) {
    json["drift"].push_back({{"segment_m", drift.segment_m},
                             {"count", drift.count},
                             {"horizontal_pct", Rounded(drift.horizontal_pct.value, 4)},
                             {"horizontal_noise_pct", Rounded(drift.horizontal_pct.noise, 4)},
                             {"height_pct", Rounded(drift.height_pct.value, 4)},
                             {"height_noise_pct", Rounded(drift.height_pct.noise, 4)}});
  }
  return json;
}

}  // namespace rigmap
