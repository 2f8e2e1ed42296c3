#include "evaluation/map_metrics.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/statistics.h"
#include "evaluation/internal/rounded.h"

namespace rigmap {
namespace {

constexpr double kWidestBand_m = kMapBands_m.back();
// m; surface points stand 1 cm apart: the plane of one holds that far.
constexpr double kPlaneReach_m = 0.02;
// m; farther is a stray whatever the distance.
constexpr double kAccuracyReach_m = 1.0, kStray_m = 0.2;
// m; beyond every tolerance, so that the search may end.
constexpr double kCompletenessReach_m = 0.2;

// What one point tells: its distance and the band it counts in.
struct Reading {
  double from_path_m = std::numeric_limits<double>::infinity();
  double distance_m = std::numeric_limits<double>::infinity();
  double sigmas = std::numeric_limits<double>::infinity();  // the distance in units of its sigma
};

double DistanceFromSurface(const MapOverTruth& map, const Eigen::Vector3d& x) {
  const TrueSurface& surface = map.truth().surface;
  const auto nearest = map.NearestOfSurface(x, kAccuracyReach_m);
  if (!nearest) return kAccuracyReach_m;
  if (nearest->distance >= kPlaneReach_m) return nearest->distance;
  const Eigen::Vector3d offset = x - surface.x_in_truth[nearest->index].cast<double>();
  return std::abs(offset.dot(surface.normal[nearest->index].cast<double>()));
}

std::vector<Reading> ReadAccuracy(const MapOverTruth& map) {
  std::vector<Reading> readings(map.size());
  tbb::parallel_for(std::size_t{0}, map.size(), [&](std::size_t i) {
    const Eigen::Vector3d x = map.MapPoint(i);
    const auto from_path_m = map.FromPath(x, kWidestBand_m);
    if (!from_path_m) return;
    readings[i] = {*from_path_m, DistanceFromSurface(map, x)};
    if (map.has_sigmas()) readings[i].sigmas = readings[i].distance_m / map.SigmaOfMapPoint(i);
  });
  return readings;
}

// Of the visible points only; the others keep an infinite distance from the path.
std::vector<Reading> ReadCompleteness(const MapOverTruth& map) {
  const TrueSurface& surface = map.truth().surface;
  std::vector<Reading> readings(surface.size());
  tbb::parallel_for(std::size_t{0}, surface.size(), [&](std::size_t i) {
    if (!surface.visible[i]) return;
    const Eigen::Vector3d x = surface.x_in_truth[i].cast<double>();
    const auto from_path_m = map.FromPath(x, kWidestBand_m);
    if (!from_path_m) return;
    readings[i].from_path_m = *from_path_m;
    const auto nearest = map.NearestOfMap(x, kCompletenessReach_m);
    if (nearest) readings[i].distance_m = nearest->distance;
  });
  return readings;
}

std::vector<double> ValuesWithin(const std::vector<Reading>& readings, double band_m,
                                 double Reading::*value) {
  const auto within = [&](const Reading& reading) { return reading.from_path_m < band_m; };
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(std::count_if(readings.begin(), readings.end(), within)));
  for (const Reading& reading : readings) {
    if (within(reading)) values.push_back(reading.*value);
  }
  return values;
}

// Whether the surface goes on as far as the band's edge: what a map shows beyond it is not wrong.
bool IsFilled(const MapOverTruth& map, double band_m) {
  constexpr double kGrain_m = 0.05;  // surface points stand a centimetre apart, the path's 5
  const auto& points = map.truth().surface.x_in_truth;
  return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3f& x) {
    return !map.FromPath(x.cast<double>(), band_m - kGrain_m);
  });
}

template <class Condition>
double ShareOf(const std::vector<double>& values, const Condition& condition) {
  return static_cast<double>(std::count_if(values.begin(), values.end(), condition)) /
         static_cast<double>(values.size());
}

std::array<double, 3> SharesWithinSigmas(const std::vector<double>& sigmas) {
  std::array<double, 3> shares{};
  for (std::size_t n = 0; n < shares.size(); ++n) {
    shares[n] = ShareOf(sigmas, [&](double value) { return value <= static_cast<double>(n + 1); });
  }
  return shares;
}

std::optional<BandMetrics> JudgeBand(std::vector<double> accuracy,
                                     const std::vector<double>& completeness) {
  if (accuracy.empty() || completeness.empty()) return std::nullopt;
  BandMetrics band;
  band.points = accuracy.size();
  band.accuracy_median_m = InterpolatedQuantile(accuracy, 0.5);
  band.accuracy_p90_m = InterpolatedQuantile(accuracy, 0.9);
  band.stray_share = ShareOf(accuracy, [](double m) { return m > kStray_m; });
  for (std::size_t k = 0; k < kMapTolerances_m.size(); ++k) {
    const auto within = [&](double m) { return m <= kMapTolerances_m[k]; };
    band.at_tolerance[k] = {ShareOf(accuracy, within), ShareOf(completeness, within)};
  }
  return band;
}

nlohmann::ordered_json BandJson(const BandMetrics& band) {
  nlohmann::ordered_json json;
  json["points"] = band.points;
  json["accuracy_median_mm"] = Rounded(1000.0 * band.accuracy_median_m, 2);
  json["accuracy_p90_mm"] = Rounded(1000.0 * band.accuracy_p90_m, 2);
  json["stray_over_20cm_pct"] = Rounded(100.0 * band.stray_share, 3);
  for (std::size_t k = 0; k < kMapTolerances_m.size(); ++k) {
    const MapShares& shares = band.at_tolerance[k];
    const std::string at = fmt::format("_{:.0f}cm", 100.0 * kMapTolerances_m[k]);
    json["precision" + at] = Rounded(shares.precision, 4);
    json["completeness" + at] = Rounded(shares.completeness, 4);
    json["f" + at] = Rounded(shares.HarmonicMean(), 4);
  }
  return json;
}

}  // namespace

double MapShares::HarmonicMean() const {
  const double sum = precision + completeness;
  return sum > 0.0 ? 2.0 * precision * completeness / sum : 0.0;
}

MapMetrics CompareMap(const MapOverTruth& map) {
  const TrueSurface& surface = map.truth().surface;
  MapMetrics metrics;
  metrics.map_points = map.size();
  metrics.truth_points = surface.size();
  metrics.visible_points = static_cast<std::size_t>(
      std::count_if(surface.visible.begin(), surface.visible.end(), [](auto v) { return v != 0; }));
  const auto accuracy = ReadAccuracy(map), completeness = ReadCompleteness(map);
  metrics.judged = kMapBands_m.size() - (IsFilled(map, kWidestBand_m) ? 0 : 1);
  for (std::size_t b = 0; b < metrics.judged; ++b) {
    const double band_m = kMapBands_m[b];
    auto& band = metrics.bands[b];
    band = JudgeBand(ValuesWithin(accuracy, band_m, &Reading::distance_m),
                     ValuesWithin(completeness, band_m, &Reading::distance_m));
    if (band && map.has_sigmas()) {
      band->within_sigmas = SharesWithinSigmas(ValuesWithin(accuracy, band_m, &Reading::sigmas));
    }
  }
  return metrics;
}

nlohmann::ordered_json ToJson(const MapMetrics& metrics) {
  nlohmann::ordered_json json;
  json["map_points"] = metrics.map_points;
  json["truth_points"] = metrics.truth_points;
  json["visible_points"] = metrics.visible_points;
  for (std::size_t b = 0; b < metrics.judged; ++b) {
    auto& band = json[fmt::format("within_{}m", kMapBands_m[b])];
    if (metrics.bands[b]) band = BandJson(*metrics.bands[b]);
  }
  return json;
}

nlohmann::ordered_json SigmasToJson(const MapMetrics& metrics) {
  nlohmann::ordered_json json;
  for (std::size_t b = 0; b < metrics.judged; ++b) {
    if (!metrics.bands[b] || !metrics.bands[b]->within_sigmas) continue;
    auto& band = json[fmt::format("within_{}m", kMapBands_m[b])];
    const auto& shares = *metrics.bands[b]->within_sigmas;
    for (std::size_t n = 0; n < shares.size(); ++n) {
      band[fmt::format("within_{}_sigma_pct", n + 1)] = Rounded(100.0 * shares[n], 2);
    }
  }
  return json;
}

}  // namespace rigmap
