#include "workflows/evaluate_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/json_text.h"
#include "evaluation/matched_poses.h"
#include "export/tum.h"
#include "workflows/format_metrics.h"
#include "workflows/part_options.h"
#include "workflows/stages/compare_result.h"
#include "workflows/stages/steps.h"
#include "workflows/truth_files.h"

namespace rigmap {
namespace {

// Throws DataError for a truth of another time. Of a result of one or two poses a match is enough.
void RequireMatch(const nlohmann::ordered_json& metrics, const std::filesystem::path& truth,
                  const EvaluationOptions& options) {
  const double coverage = metrics.value("coverage", 0.0);
  if (!metrics.contains("error")) return;
  if (metrics.contains("inside")) {
    throw DataError(
        fmt::format("{}: expected a track of the time of the result, found {} of its {} "
                    "poses in it",
                    truth.string(), metrics["inside"].get<int>(), metrics["frames"].get<int>()));
  }
  if (metrics["frames"] < kMinMatches && coverage > 0.0) return;
  const double matched = std::round(coverage * metrics.value("gt_frames", 0.0));
  throw DataError(fmt::format(
      "{}: expected {} poses or more within {} s of the {} of the result, found {:.0f} such",
      truth.string(), kMinMatches, options.max_dt_s, metrics["frames"].get<int>(), matched));
}

bool IsJoined(const std::filesystem::path& out) {
  const auto path = out / "summary.json";
  if (!std::filesystem::exists(path)) return false;
  const auto summary = nlohmann::json::parse(ReadTextFile(path), nullptr, false);
  return summary.is_object() && summary.contains("technique") && summary["technique"] == "join";
}

// Those that stand in every result in their order, then those of parts.
std::vector<std::filesystem::path> StepFiles(const std::filesystem::path& out) {
  const auto folder = out / "steps";
  std::vector<std::filesystem::path> files, of_parts;
  for (const char* step : kStepNames) {
    auto tum = folder / fmt::format("{}.tum", step);
    if (std::filesystem::exists(tum)) files.push_back(std::move(tum));
  }
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".tum" || std::ranges::count(files, entry.path())) continue;
    of_parts.push_back(entry.path());
  }
  std::ranges::sort(of_parts);
  files.insert(files.end(), of_parts.begin(), of_parts.end());
  return files;
}

nlohmann::ordered_json Metrics(const EvaluateRequest& request) {
  if (request.truth) {
    if (!std::filesystem::exists(request.out / "trajectory.tum")) {
      throw DataError(fmt::format("{}: expected the results of a run, found no trajectory.tum",
                                  request.out.string()));
    }
    const auto config = request.out / "config.yaml";
    const PartOptions options =
        std::filesystem::exists(config) ? LoadPartOptions(config, {}) : PartOptions();
    const auto truth =
        IsJoined(request.out) ? WholeTruth(*request.truth) : TruthFile(*request.truth);
    auto metrics = CompareWithTruth(ReadTum(request.out / "trajectory.tum"), truth,
                                    request.out / "dense.ply", options.evaluation);
    RequireMatch(metrics, truth, options.evaluation);
    WarnOfTruth(metrics, truth);
    for (const auto& tum : StepFiles(request.out)) {
      metrics["steps"][tum.stem().string()] =
          CompareWithTruth(ReadTum(tum), truth, {}, options.evaluation);
    }
    return metrics;
  }
  const auto path = request.out / "evaluation.json";
  if (!std::filesystem::exists(path)) {
    if (!std::filesystem::exists(request.out / "summary.json")) {
      throw DataError(fmt::format("{}: expected the results of a run, found no summary.json",
                                  request.out.string()));
    }
    throw DataError(
        fmt::format("{}: expected an evaluation, found none, since the run had no truth "
                    "or ended before that stage; give --truth",
                    path.string()));
  }
  return TakeFromJson(path, "JSON",
                      [&] { return nlohmann::ordered_json::parse(ReadTextFile(path)); });
}

// Per cent; nothing where no truth tells.
std::optional<double> ScaleErrorPct(const nlohmann::ordered_json& metrics) {
  if (const auto error = metrics.find("scale_error_pct"); error != metrics.end()) {
    return error->get<double>();
  }
  const auto factor = metrics.find("scale_truth_over_est");
  if (factor == metrics.end()) return std::nullopt;
  return 100.0 * std::abs(factor->get<double>() - 1.0);
}

// Two digits; without an exponent where a truth is in other units, say.
std::string PerCent(double value) {
  return value < 99.5 ? fmt::format("{:.2g} %", value) : fmt::format("{:.0f} %", value);
}

// Whether the result is trusted, how good it says it is, and whether the truth bears that out.
std::string Standing(const std::filesystem::path& out, const nlohmann::ordered_json& metrics) {
  const auto path = out / "summary.json";
  if (!std::filesystem::exists(path)) return "";
  const auto error_pct = ScaleErrorPct(metrics);
  return TakeFromJson(path, "the summary of a run", [&] {
    const auto summary = nlohmann::ordered_json::parse(ReadTextFile(path));
    const std::string status = summary.at("status");
    const auto& text = summary.at("verdict").at("text");
    const auto& stated = summary.at("verdict").value("scale_95_pct", nlohmann::ordered_json());
    std::string lines = fmt::format("{}{}\n",
                                    status == "untrusted" ? "NOT TRUSTED"
                                    : status != "ok"      ? status
                                    : stated.is_number()  ? "trusted"
                                                          : "consistent",
                                    text.is_string() ? ": " + text.get<std::string>() : "");
    if (error_pct && stated.is_number()) {
      const double stated_pct = stated;
      const bool is_within = *error_pct <= stated_pct;
      lines += fmt::format("scale off by {}, {} the {} stated{}\n", PerCent(*error_pct),
                           is_within ? "within" : "more than", PerCent(stated_pct),
                           is_within ? "" : ": this or the truth is wrong");
    }
    return lines;
  });
}

}  // namespace

std::string EvaluatePart(const EvaluateRequest& request) {
  const auto metrics = Metrics(request);
  if (request.json) return JsonText(metrics) + "\n";
  return TakeFromJson(request.out / "evaluation.json", "an evaluation",
                      [&] { return Standing(request.out, metrics) + FormatMetrics(metrics); });
}

}  // namespace rigmap
