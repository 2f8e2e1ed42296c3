#include "evaluation/prism_metrics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/internal/prism_fitter.h"
#include "evaluation/internal/rounded.h"

namespace rigmap {
namespace {

constexpr std::size_t kStride = 5;  // of the poses that lengths are measured over

PrismFit Describe(const PrismFitter& fitter, const PrismParameters& x) {
  PrismFit fit{.heading_rad = x(0),
               .shift = x.segment<2>(1),
               .prism_in_body = x.segment<3>(3),
               .clock_offset_s = x(6),
               .scale = std::exp(x(7))};
  double squares = 0.0;
  for (const Eigen::Vector3d& difference : fitter.Differences(x)) {
    if (difference.z() == 0.0) continue;
    ++fit.inside;
    squares += difference.head<2>().squaredNorm();
    fit.max_m = std::max(fit.max_m, difference.head<2>().norm());
  }
  if (fit.inside > 0) fit.rms_m = std::sqrt(squares / static_cast<double>(fit.inside));
  return fit;
}

double LengthOf(const std::vector<Eigen::Vector2d>& path) {
  double length_m = 0.0;
  for (std::size_t i = kStride; i < path.size(); i += kStride) {
    length_m += (path[i] - path[i - kStride]).norm();
  }
  return length_m;
}

void MeasurePaths(const PrismFitter& fitter, const PrismParameters& x,
                  std::span<const TumPose> poses, PrismMetrics& metrics) {
  const auto differences = fitter.Differences(x);
  std::vector<Eigen::Vector2d> track, body;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (differences[i].z() == 0.0) continue;
    track.push_back(fitter.TrackAt(fitter.SecondsOf(i), x(6)));
    body.push_back(poses[i].world_from_body.translation.head<2>());
  }
  metrics.true_path_m = LengthOf(track);
  metrics.estimated_path_m = LengthOf(body);
}

nlohmann::ordered_json LeverToJson(const Eigen::Vector3d& lever_m) {
  return {Rounded(lever_m.x(), 3), Rounded(lever_m.y(), 3), Rounded(lever_m.z(), 3)};
}

}  // namespace

PrismMetrics ComparePrism(std::span<const TumPose> world_from_body,
                          std::span<const PrismPosition> track) {
  PrismMetrics metrics{.frames = world_from_body.size()};
  if (track.size() < 2 || world_from_body.empty()) return metrics;
  const PrismFitter fitter(world_from_body, track);
  if (fitter.CountInside(PrismParameters::Zero()) < PrismFitter::kMinInside) return metrics;
  const PrismParameters rigid = fitter.Fit(false);
  metrics.rigid = Describe(fitter, rigid);
  metrics.similar = Describe(fitter, fitter.Fit(true));
  MeasurePaths(fitter, rigid, world_from_body, metrics);
  return metrics;
}

nlohmann::ordered_json ToJson(const PrismMetrics& metrics) {
  nlohmann::ordered_json json;
  json["frames"] = metrics.frames;
  json["inside"] = metrics.rigid ? metrics.rigid->inside : 0;
  if (!metrics.rigid || !metrics.similar) {
    json["error"] = "fewer than 4 poses in the time of the prism's track";
    return json;
  }
  const PrismFit &rigid = *metrics.rigid, &similar = *metrics.similar;
  json["truth_path_m"] = Rounded(metrics.true_path_m, 3);
  json["est_path_m"] = Rounded(metrics.estimated_path_m, 3);
  json["rms_se2_m"] = Rounded(rigid.rms_m, 4);
  json["max_se2_m"] = Rounded(rigid.max_m, 4);
  if (metrics.true_path_m > 0.0) {
    json["rms_se2_pct"] = Rounded(100.0 * rigid.rms_m / metrics.true_path_m, 3);
  }
  json["rms_sim2_m"] = Rounded(similar.rms_m, 4);
  json["scale_truth_over_est"] = Rounded(similar.scale, 5);
  json["lever"] = LeverToJson(rigid.prism_in_body);
  json["lever_sim"] = LeverToJson(similar.prism_in_body);
  json["dt_s"] = Rounded(rigid.clock_offset_s, 3);
  json["dt_sim"] = Rounded(similar.clock_offset_s, 3);
  return json;
}

}  // namespace rigmap
