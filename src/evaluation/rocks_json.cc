#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluation/internal/rounded.h"
#include "evaluation/rock_metrics.h"

namespace rigmap {
namespace {

using nlohmann::ordered_json;

constexpr double kMaxSigmaStretch = 0.02;  // a stretch known worse than this says nothing

ordered_json ThreeNumbers(const Eigen::Vector3d& values) {
  return {Rounded(values.x(), 3), Rounded(values.y(), 3), Rounded(values.z(), 3)};
}

ordered_json RockJson(const RockMetrics& metrics) {
  ordered_json json;
  json["size"] = metrics.rock.size;
  json["x"] = Rounded(metrics.rock.x_in_truth.x(), 2);
  json["y"] = Rounded(metrics.rock.x_in_truth.y(), 2);
  json["visible"] = metrics.visible_points;
  json["complete_2cm"] = Rounded(metrics.completeness, 3);
  json["found"] = metrics.Found();
  if (metrics.deformation) {
    json["shift_mm"] = Rounded(1000.0 * metrics.deformation->shift_m, 1);
    json["stretch"] = ThreeNumbers(metrics.deformation->stretch);
    json["sigma_stretch"] = ThreeNumbers(metrics.deformation->sigma_stretch);
  }
  if (metrics.ghost_share) {
    auto& top = json["top_mm"];
    if (metrics.top_m) top = Rounded(1000.0 * *metrics.top_m, 1);
    json["ghost_pct"] = Rounded(100.0 * *metrics.ghost_share, 2);
  }
  return json;
}

// The largest departure from 1 that is known well enough.
double StretchOff(const ordered_json& rock) {
  double off = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(rock["sigma_stretch"][axis].get<double>() < kMaxSigmaStretch)) continue;
    off = std::max(off, std::abs(rock["stretch"][axis].get<double>() - 1.0));
  }
  return Rounded(off, 3);
}

double NumberOrZero(const ordered_json& rock, const char* key) {
  return rock.contains(key) && rock[key].is_number() ? rock[key].get<double>() : 0.0;
}

// Over the rocks that have a deformation; null if there is none. Of rounded numbers, so that each
// is found again among those of its rock.
template <class Value>
ordered_json Worst(const ordered_json& rocks, const Value& value) {
  ordered_json worst;
  for (const auto& rock : rocks) {
    if (!rock.contains("stretch")) continue;
    worst = worst.is_null() ? value(rock) : std::max(worst.template get<double>(), value(rock));
  }
  return worst;
}

}  // namespace

ordered_json ToJson(const std::vector<RockMetrics>& rocks) {
  ordered_json each = ordered_json::array();
  for (const RockMetrics& rock : rocks) each.push_back(RockJson(rock));
  ordered_json json;
  json["rocks"] = rocks.size();
  json["found"] = std::count_if(rocks.begin(), rocks.end(),
                                [](const RockMetrics& rock) { return rock.Found(); });
  json["shift_max_mm"] =
      Worst(each, [](const auto& rock) { return rock["shift_mm"].template get<double>(); });
  json["stretch_max_off"] = Worst(each, StretchOff);
  json["top_max_mm"] =
      Worst(each, [](const auto& rock) { return std::abs(NumberOrZero(rock, "top_mm")); });
  json["ghost_max_pct"] =
      Worst(each, [](const auto& rock) { return NumberOrZero(rock, "ghost_pct"); });
  json["each"] = std::move(each);
  return json;
}

}  // namespace rigmap
