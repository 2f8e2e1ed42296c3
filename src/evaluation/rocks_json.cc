#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "evaluation/internal/rounded.h"
#include "evaluation/rock_metrics.h"

namespace rigmap {
namespace {

using nlohmann::ordered_json;

constexpr double kMaxSigmaStretch = 0.02;  // a stretch known worse than this says nothing

double Millimetres(double m) { return Rounded(1000.0 * m, 1); }
double Per100(double share, int decimals) { return Rounded(100.0 * share, decimals); }

ordered_json Millimetres(const Eigen::Vector3d& m) {
  return {Millimetres(m.x()), Millimetres(m.y()), Millimetres(m.z())};
}

ordered_json Factors(const Eigen::Vector3d& values) {
  return {Rounded(values.x(), 3), Rounded(values.y(), 3), Rounded(values.z(), 3)};
}

void PutShift(ordered_json& json, const RockShift& shift) {
  json["shift_mm"] = Millimetres(shift.along_axes_m.norm());
  json["shift_vector_mm"] = Millimetres(shift.along_axes_m);
  json["shift_directions"] = shift.directions;
  json["sigma_shift_mm"] = Millimetres(shift.sigma_m);
}

void PutStretch(ordered_json& json, const RockStretch& stretch) {
  json["stretch"] = Factors(stretch.along_axes);
  json["sigma_stretch"] = Factors(stretch.sigma);
  json["rms_mm"] = Millimetres(stretch.rms_m);
  json["doubled_pct"] = Per100(stretch.doubled_share, 1);
}

ordered_json RockJson(const RockMetrics& metrics) {
  ordered_json json;
  json["size"] = metrics.rock.size;
  json["x"] = Rounded(metrics.rock.x_in_truth.x(), 2);
  json["y"] = Rounded(metrics.rock.x_in_truth.y(), 2);
  json["distance_m"] = Rounded(metrics.from_path_m, 2);
  json["visible"] = metrics.visible_points;
  json["complete_2cm"] = Rounded(metrics.completeness, 3);
  json["found"] = metrics.Found();
  for (const char* key : {"shift_mm", "stretch", "sigma_stretch", "top_mm", "ghost_pct"}) {
    json[key] = nullptr;
  }
  if (metrics.shift) PutShift(json, *metrics.shift);
  if (metrics.stretch) PutStretch(json, *metrics.stretch);
  if (metrics.top_m) json["top_mm"] = Millimetres(*metrics.top_m);
  if (metrics.ghosts) {
    json["ghost_pct"] = Per100(metrics.ghosts->over_3cm_share, 2);
    json["ghost_4cm_pct"] = Per100(metrics.ghosts->over_4cm_share, 2);
  }
  return json;
}

// The largest magnitude under `key`; null if no rock has one. Of rounded numbers, so that each is
// found again among those of its rock.
ordered_json Worst(const ordered_json& rocks, const char* key) {
  ordered_json worst;
  for (const auto& rock : rocks) {
    if (!rock.contains(key) || rock[key].is_null()) continue;
    const double value = std::abs(rock[key].get<double>());
    worst = worst.is_null() ? value : std::max(worst.get<double>(), value);
  }
  return worst;
}

// How far the stretches that are known well enough are from 1; and whether any was fitted at all.
struct StretchesOff {
  bool fitted = false;
  std::vector<double> known;
};

StretchesOff CollectStretches(const ordered_json& rocks) {
  StretchesOff off;
  for (const auto& rock : rocks) {
    if (rock["stretch"].is_null()) continue;
    off.fitted = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(rock["sigma_stretch"][axis].get<double>() < kMaxSigmaStretch)) continue;
      off.known.push_back(Rounded(std::abs(rock["stretch"][axis].get<double>() - 1.0), 3));
    }
  }
  return off;
}

}  // namespace

ordered_json ToJson(const std::vector<RockMetrics>& rocks) {
  ordered_json each = ordered_json::array();
  for (const RockMetrics& rock : rocks) each.push_back(RockJson(rock));
  const StretchesOff off = CollectStretches(each);
  ordered_json json;
  json["rocks"] = rocks.size();
  json["found"] = std::ranges::count_if(rocks, &RockMetrics::Found);
  json["shift_max_mm"] = Worst(each, "shift_mm");
  auto& stretch_max_off = json["stretch_max_off"];
  if (off.fitted) {
    stretch_max_off = off.known.empty() ? 0.0 : *std::ranges::max_element(off.known);
  }
  json["stretch_counted"] = off.known.size();
  json["top_max_mm"] = Worst(each, "top_mm");
  json["ghost_max_pct"] = Worst(each, "ghost_pct");
  json["ghost_4cm_max_pct"] = Worst(each, "ghost_4cm_pct");
  json["doubled_max_pct"] = Worst(each, "doubled_pct");
  json["each"] = std::move(each);
  return json;
}

}  // namespace rigmap
