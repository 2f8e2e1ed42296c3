#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/internal/rounded.h"
#include "evaluation/trajectory_metrics.h"

namespace rigmap {
namespace {

void Put(nlohmann::ordered_json& json, const char* key, std::optional<double> value, int decimals) {
  if (value) json[key] = Rounded(*value, decimals);
}

void PutAligned(nlohmann::ordered_json& json, const AlignedError& aligned) {
  Put(json, "ate_se3_m", aligned.ate_se3_m, 5);
  Put(json, "ate_sim3_m", aligned.ate_sim3_m, 5);
  Put(json, "ate_se3_pct", aligned.ate_se3_pct, 4);
  Put(json, "scale", aligned.scale, 5);
  if (aligned.scale) Put(json, "scale_error_pct", 100.0 * std::abs(*aligned.scale - 1.0), 3);
}

void PutRelative(nlohmann::ordered_json& json, const RelativeError& relative) {
  Put(json, "segment_m", relative.segment_m, 3);
  Put(json, "rpe_t_pct", relative.translation_pct, 4);
  Put(json, "rpe_r_deg_per_m", relative.rotation_deg_per_m, 5);
}

}  // namespace

nlohmann::ordered_json ToJson(const TrajectoryMetrics& metrics) {
  nlohmann::ordered_json json;
  json["frames"] = metrics.frames;
  json["gt_frames"] = metrics.true_frames;
  Put(json, "coverage", metrics.coverage, 4);
  Put(json, "path_m", metrics.true_path_m, 3);
  Put(json, "est_path_m", metrics.estimated_path_m, 3);
  Put(json, "extent_m", metrics.extent_m, 5);
  if (metrics.aligned) {
    PutAligned(json, *metrics.aligned);
  } else {
    json["error"] = "fewer than 3 matched poses";
  }
  if (metrics.relative) PutRelative(json, *metrics.relative);
  return json;
}

nlohmann::ordered_json DriftToJson(const TrajectoryMetrics& metrics) {
  nlohmann::ordered_json json;
  if (metrics.height) {
    Put(json, "height_rms_m", metrics.height->rms_m, 5);
    Put(json, "height_drift_pct", metrics.height->drift_pct, 4);
  }
  for (const RelativeError& drift : metrics.drift) {
    PutRelative(json["segments"].emplace_back(nlohmann::ordered_json::object()), drift);
  }
  return json;
}

}  // namespace rigmap
