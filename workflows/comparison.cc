#include "workflows/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/json_text.h"
#include "core/statistics.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = nlohmann::json_pointer<std::string>;

// Where evaluation.json has the numbers of a row.
struct Source {
  const char* name;
  const char* pointer;
};
constexpr std::array kEvaluated{
    Source{"path_m", "/path_m"},
    Source{"ate_se3_m", "/ate_se3_m"},
    Source{"ate_se3_pct", "/ate_se3_pct"},
    Source{"scale", "/scale"},
    Source{"scale_error_pct", "/scale_error_pct"},
    Source{"height_rms_m", "/drift/height_rms_m"},
    Source{"height_drift_pct", "/drift/height_drift_pct"},
    Source{"f_1cm_within_1.5m", "/map/within_1.5m/f_1cm"},
    Source{"f_1cm_within_2.5m", "/map/within_2.5m/f_1cm"},
    Source{"f_1cm_within_3.5m", "/map/within_3.5m/f_1cm"},
    Source{"f_5cm_within_3.5m", "/map/within_3.5m/f_5cm"},
    Source{"rocks_found", "/rocks/found"},
    Source{"rock_shift_mm", "/rocks/shift_max_mm"},
    Source{"rock_stretch", "/rocks/stretch_max_off"},
    Source{"rock_top_mm", "/rocks/top_max_mm"},
    Source{"rock_ghosts_pct", "/rocks/ghost_max_pct"},
    Source{"rtk_rms_m", "/rtk/rms_residual_m"},
    Source{"rtk_noise_m", "/rtk/noise_m"},
    Source{"rtk_rms_pct", "/rtk/rms_pct"},
    Source{"rtk_noise_pct", "/rtk/noise_pct"},
    Source{"rtk_height_rms_m", "/rtk/height_rms_m"},
    Source{"rtk_height_noise_m", "/rtk/height_noise_m"},
    Source{"rtk_height_drift_pct", "/rtk/height_drift_pct"},
    Source{"rtk_height_drift_noise_pct", "/rtk/height_drift_noise_pct"},
    Source{"rtk_scale_error_pct", "/rtk/scale_error_pct"},
    Source{"odometry_ate_pct", "/steps/odometry/ate_se3_pct"},
    Source{"odometry_scale_error_pct", "/steps/odometry/scale_error_pct"},
    Source{"mapping_ate_pct", "/steps/mapping/ate_se3_pct"},
    Source{"mapping_scale_error_pct", "/steps/mapping/scale_error_pct"}};
// What a prism's track says of the same, in the plane.
constexpr std::array kTracked{Source{"path_m", "/truth_path_m"},
                              Source{"ate_se3_m", "/rms_se2_m"},
                              Source{"ate_se3_pct", "/rms_se2_pct"},
                              Source{"scale", "/scale_truth_over_est"},
                              Source{"odometry_ate_pct", "/steps/odometry/rms_se2_pct"},
                              Source{"mapping_ate_pct", "/steps/mapping/rms_se2_pct"}};
constexpr std::array kDriftLengths{5, 10, 25, 50, 100};

// Columns that tell rows apart or are words.
const std::array<std::string, 12> kWords{"part",   "technique", "setting",   "repeat",
                                         "run",    "truth",     "exit",      "status",
                                         "reason", "verdict",   "judged_by", "rtk_remark"};

bool IsNumber(const std::string& column) {
  return std::ranges::find(kWords, column) == kWords.end();
}

Json Start(const RunName& name) {
  return {{"part", name.part},       {"technique", name.technique},
          {"setting", name.setting}, {"repeat", name.repeat},
          {"run", name.run},         {"truth", name.truth}};
}

Json At(const Json& json, const std::string& pointer) {
  const Pointer where(pointer);
  return json.contains(where) ? json.at(where) : Json(nullptr);
}

Json ParseFile(const std::filesystem::path& path) {
  return TakeFromJson(path, "JSON", [&] { return Json::parse(ReadTextFile(path)); });
}

// A cell for each length, after a pattern with a place for it.
void PutDrift(fmt::string_view pattern, const Json& segments, const char* figure, Json& row) {
  for (const int length_m : kDriftLengths) {
    Json& cell = row[fmt::format(fmt::runtime(pattern), length_m)] = nullptr;
    for (const Json& drift : segments) {
      if (drift.at("segment_m") == length_m) cell = drift.at(figure);
    }
  }
}

void PutEvaluation(const Json& evaluation, Json& row) {
  const bool tracked = evaluation.contains("rms_se2_m");
  row["judged_by"] = tracked                            ? Json(kPrismJudge)
                     : evaluation.contains("ate_se3_m") ? Json("poses")
                                                        : Json(nullptr);
  for (const Source& source : kEvaluated) row[source.name] = At(evaluation, source.pointer);
  if (tracked) {
    for (const Source& source : kTracked) row[source.name] = At(evaluation, source.pointer);
    row["scale_error_pct"] = 100.0 * std::abs(row["scale"].get<double>() - 1.0);
  }
  row["rtk_remark"] = At(evaluation, "/rtk/why");
  // Of rtk_scale_error_pct, in the same unit.
  const Json scale_noise = At(evaluation, "/rtk/scale_noise");
  row["rtk_scale_noise_pct"] =
      scale_noise.is_number() ? Json(100.0 * scale_noise.get<double>()) : Json(nullptr);
  PutDrift("drift_{}m_pct", At(evaluation, "/drift/segments"), "rpe_t_pct", row);
  PutDrift("rtk_drift_{}m_pct", At(evaluation, "/rtk/drift"), "horizontal_pct", row);
  PutDrift("rtk_drift_noise_{}m_pct", At(evaluation, "/rtk/drift"), "horizontal_noise_pct", row);
}

// Share of the frames whose pose is more than a prediction.
Json Coverage(const Json& summary) {
  const Json paired = At(summary, "/frames/paired"),
             guessed = At(summary, "/verdict/known/guessed");
  if (!paired.is_number() || !guessed.is_array() || paired == 0) return nullptr;
  double count = 0.0;
  for (const Json& range : guessed) count += range.at(1).get<double>() - range.at(0).get<double>();
  return 100.0 * (1.0 - count / paired.get<double>());
}

void PutCost(const Json& summary, Json& row) {
  for (const char* name : {"seconds", "seconds_per_pair", "peak_rss_mb"}) row[name] = nullptr;
  if (!summary.contains("stages")) return;
  double seconds = 0.0, peak_mb = 0.0;
  for (const Json& stage : summary.at("stages")) {
    seconds += stage.at("seconds").get<double>();
    peak_mb = std::max(peak_mb, stage.at("peak_rss_mb").get<double>());
  }
  const Json paired = At(summary, "/frames/paired");
  row["seconds"] = seconds;
  row["seconds_per_pair"] =
      paired.is_number() && paired > 0 ? Json(seconds / paired.get<double>()) : Json(nullptr);
  row["peak_rss_mb"] = peak_mb;
}

// All columns that a run tells; null where it does not.
void PutFindings(const Json& summary, Json& row) {
  row["verdict"] = At(summary, "/verdict/text");
  row["frames"] = At(summary, "/frames/paired");
  row["coverage_pct"] = Coverage(summary);
  row["scale_95_pct"] = At(summary, "/verdict/scale_95_pct");
  row["position_95_m"] = At(summary, "/verdict/position_95_m");
  PutCost(summary, row);
  PutEvaluation(Json::object(), row);
}

int ExitCodeOf(const std::string& status) {
  return status == "untrusted" ? 3 : status == "failed" ? 1 : 0;
}

// Part, technique and setting: what repeats have in common.
std::string GroupOf(const Json& row) {
  return fmt::format("{}\n{}\n{}", row.at("part").get<std::string>(),
                     row.at("technique").get<std::string>(), row.at("setting").get<std::string>());
}

std::vector<double> NumbersOf(const std::vector<const Json*>& rows, const std::string& column) {
  std::vector<double> numbers;
  for (const Json* row : rows) {
    if (row->contains(column) && (*row)[column].is_number()) numbers.push_back((*row)[column]);
  }
  return numbers;
}

Json MedianOfGroup(const std::vector<const Json*>& rows, const std::vector<std::string>& columns) {
  Json medians = {{"part", rows.front()->at("part")},
                  {"technique", rows.front()->at("technique")},
                  {"setting", rows.front()->at("setting")},
                  {"judged_by", rows.front()->value("judged_by", Json(nullptr))},
                  {"runs", rows.size()}};
  for (const char* status : {"ok", "untrusted", "failed"}) {
    medians[status] =
        std::ranges::count_if(rows, [&](const Json* row) { return row->at("status") == status; });
  }
  for (const std::string& column : columns) {
    if (!IsNumber(column)) continue;
    std::vector<double> numbers = NumbersOf(rows, column);
    if (numbers.empty()) {
      medians[column] = nullptr;
      continue;
    }
    const auto [least, most] = std::ranges::minmax(numbers);
    medians[column] = {{"median", InterpolatedQuantile(numbers, 0.5)}, {"spread", most - least}};
  }
  return medians;
}

}  // namespace

ComparisonRow MakeRow(const RunName& name, const std::filesystem::path& out) {
  const auto path = out / "summary.json";
  if (!std::filesystem::exists(path)) {
    throw DataError(
        fmt::format("{}: expected the results of a run, found no summary.json", out.string()));
  }
  const Json summary = ParseFile(path);
  Json row = Start(name);
  TakeFromJson(path, "the summary of a run", [&] {
    const std::string status = summary.at("status");
    row["exit"] = ExitCodeOf(status);
    row["status"] = status;
    row["reason"] = summary.at("reason");
    PutFindings(summary, row);
  });
  const auto evaluation = out / "evaluation.json";
  if (!std::filesystem::exists(evaluation)) return row;
  TakeFromJson(evaluation, "an evaluation", [&] { PutEvaluation(ParseFile(evaluation), row); });
  return row;
}

ComparisonRow MakeFailedRow(const RunName& name, int exit_code, const std::string& reason) {
  Json row = Start(name);
  row["exit"] = exit_code;
  row["status"] = "failed";
  row["reason"] = reason;
  PutFindings(Json::object(), row);
  return row;
}

std::vector<std::string> ColumnsOf(const std::vector<ComparisonRow>& rows) {
  std::vector<std::string> columns;
  for (const Json& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
    }
  }
  return columns;
}

std::vector<std::string> SettingsWithoutEffect(const std::vector<ComparisonRow>& rows) {
  std::map<std::string, std::vector<std::string>> settings;  // by everything that is alike
  for (const Json& row : rows) {
    if (row.at("status") == "failed") continue;
    Json figures = row;
    for (const char* name : {"setting", "run", "seconds", "seconds_per_pair", "peak_rss_mb"}) {
      figures.erase(name);
    }
    settings[JsonText(figures)].push_back(row.at("setting"));
  }
  std::set<std::string> remarks;  // repeats say the same
  for (const auto& [figures, alike] : settings) {
    if (alike.size() < 2) continue;
    const Json row = Json::parse(figures);
    std::vector<std::string> quoted;
    for (const std::string& setting : alike) quoted.push_back(fmt::format("'{}'", setting));
    remarks.insert(fmt::format("{}, {}: no figure differs between {}",
                               row["part"].get<std::string>(), row["technique"].get<std::string>(),
                               fmt::join(quoted, ", ")));
  }
  return {remarks.begin(), remarks.end()};
}

Json WriteComparison(const std::vector<ComparisonRow>& rows) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<const Json*>> groups;
  for (const Json& row : rows) {
    auto& group = groups[GroupOf(row)];
    if (group.empty()) order.push_back(GroupOf(row));
    group.push_back(&row);
  }
  const std::vector<std::string> columns = ColumnsOf(rows);
  Json comparison = {{"rows", rows}, {"medians", Json::array()}};
  for (const std::string& group : order) {
    comparison["medians"].push_back(MedianOfGroup(groups.at(group), columns));
  }
  return comparison;
}

}  // namespace rigmap
