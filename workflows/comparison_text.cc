// A comparison as CSV and as a table.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/json_text.h"
#include "workflows/comparison.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

std::string CsvCell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return JsonText(value);
  std::string text = value;
  for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) {
    text.insert(i, 1, '"');
  }
  return fmt::format("\"{}\"", text);
}

bool IsHorizontal(const Json& medians) {
  return medians.contains("judged_by") && medians["judged_by"] == kPrismJudge;
}

constexpr const char* kNone = "-";

// A column of the table for people.
struct Column {
  std::string heading;
  std::function<std::string(const Json& medians)> text;
};

Column Figure(const std::string& heading, const std::string& name, int decimals) {
  return {heading, [=](const Json& medians) {
            if (!medians.contains(name) || !medians[name].is_object()) return std::string(kNone);
            const double spread = medians[name]["spread"];
            const std::string median =
                fmt::format("{:.{}f}", medians[name]["median"].get<double>(), decimals);
            return spread > 0.0 ? fmt::format("{}±{:.{}f}", median, 0.5 * spread, decimals)
                                : median;
          }};
}

// The error of a row that a prism judges is marked.
Column AteFigure(const std::string& heading, const std::string& name, int decimals) {
  const Column figure = Figure(heading, name, decimals);
  return {heading, [=](const Json& medians) {
            return figure.text(medians) + (IsHorizontal(medians) ? " h" : "");
          }};
}

// Beside it, in brackets, what the noise of the fixes alone would make.
Column WithNoise(const std::string& heading, const std::string& name, const std::string& noise) {
  const Column figure = Figure(heading, name, 4), floor = Figure(heading, noise, 4);
  return {heading, [=](const Json& medians) {
            const std::string text = figure.text(medians);
            return text == kNone ? text : fmt::format("{} ({})", text, floor.text(medians));
          }};
}

Column Word(const std::string& heading, const std::string& name) {
  return {heading, [=](const Json& medians) { return medians.at(name).get<std::string>(); }};
}

// Characters on a terminal, of UTF-8.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string WriteComparisonCsv(const std::vector<ComparisonRow>& rows) {
  const std::vector<std::string> columns = ColumnsOf(rows);
  std::string text = fmt::format("{}\n", fmt::join(columns, ","));
  for (const Json& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& column : columns) {
      cells.push_back(row.contains(column) ? CsvCell(row[column]) : "");
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

std::string FormatComparison(const Json& comparison) {
  const std::vector<Column> columns{
      Word("part", "part"),
      Word("technique", "technique"),
      Word("setting", "setting"),
      {"ok/no/failed",
       [](const Json& medians) {
         return fmt::format("{}/{}/{}", medians["ok"].get<int>(), medians["untrusted"].get<int>(),
                            medians["failed"].get<int>());
       }},
      Figure("posed %", "coverage_pct", 0),
      AteFigure("ATE m", "ate_se3_m", 4),
      AteFigure("ATE %", "ate_se3_pct", 4),
      Figure("scale %", "scale_error_pct", 3),
      Figure("says %", "scale_95_pct", 2),
      Figure("height m", "height_rms_m", 4),
      Figure("height drift %", "height_drift_pct", 3),
      Figure("5 m %", "drift_5m_pct", 3),
      Figure("10 m %", "drift_10m_pct", 3),
      Figure("25 m %", "drift_25m_pct", 3),
      Figure("50 m %", "drift_50m_pct", 3),
      Figure("100 m %", "drift_100m_pct", 3),
      WithNoise("RTK m", "rtk_rms_m", "rtk_noise_m"),
      WithNoise("RTK height m", "rtk_height_rms_m", "rtk_height_noise_m"),
      Figure("F 1 cm", "f_1cm_within_1.5m", 3),
      Figure("F 3.5 m", "f_1cm_within_3.5m", 3),
      Figure("rocks", "rocks_found", 0),
      Figure("rock mm", "rock_shift_mm", 1),
      Figure("top mm", "rock_top_mm", 1),
      Figure("ghosts %", "rock_ghosts_pct", 1),
      Figure("s/pair", "seconds_per_pair", 2),
      Figure("peak MB", "peak_rss_mb", 0)};
  const Json& medians = comparison.at("medians");
  std::vector<std::string> lines(medians.size() + 1);
  for (const Column& column : columns) {
    std::vector<std::string> cells{column.heading};
    for (const Json& row : medians) cells.push_back(column.text(row));
    if (std::all_of(cells.begin() + 1, cells.end(), [](auto& cell) { return cell == kNone; })) {
      continue;
    }
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, Width(cell));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      lines[i] += cells[i] + std::string(width - Width(cells[i]) + 2, ' ');
    }
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  if (std::ranges::any_of(medians, IsHorizontal)) {
    lines.push_back("h: horizontal, beside the track of a prism");
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace rigmap
