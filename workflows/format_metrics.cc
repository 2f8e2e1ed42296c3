#include "workflows/format_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/json_text.h"
#include "evaluation/step_figures.h"

namespace rigmap {
namespace {

using nlohmann::ordered_json;
using Lines = std::vector<std::pair<std::string, const ordered_json*>>;  // name and value

void Collect(const ordered_json& metrics, const std::string& prefix, Lines& lines) {
  for (const auto& [name, value] : metrics.items()) {
    if (value.is_object()) {
      Collect(value, prefix + name + ".", lines);
    } else {
      lines.emplace_back(prefix + name, &value);
    }
  }
}

std::string CellText(const ordered_json& row, const std::string& column) {
  if (!row.contains(column)) return "-";
  const ordered_json& value = row[column];
  return value.is_string() ? value.get<std::string>() : JsonText(value);
}

std::string FormatTable(const ordered_json& rows) {
  std::vector<std::string> columns;
  for (const auto& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
    }
  }
  std::vector<std::string> lines(rows.size() + 1);
  for (const std::string& column : columns) {
    std::vector<std::string> cells{column};
    for (const auto& row : rows) cells.push_back(CellText(row, column));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      lines[i] += fmt::format("  {:>{}}", cells[i], width);
    }
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

bool IsTable(const ordered_json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const auto& row) { return row.is_object(); });
}

// What tells steps apart, of all that is known of each.
ordered_json RowsOfSteps(const ordered_json& steps) {
  ordered_json rows = ordered_json::array();
  for (const auto& [name, step] : steps.items()) {
    ordered_json row{{"step", name}};
    for (const char* key : kStepFigures) {
      const ordered_json::json_pointer pointer(fmt::format("/{}", key));
      if (step.contains(pointer)) row[key] = step[pointer];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::string FormatMetrics(const ordered_json& metrics) {
  ordered_json all = metrics;
  if (all.contains("steps") && all["steps"].is_object()) all["steps"] = RowsOfSteps(all["steps"]);
  Lines lines;
  Collect(all, "", lines);
  std::size_t width = 16;
  for (const auto& [name, value] : lines) width = std::max(width, name.size());
  std::string text;
  for (const auto& [name, value] : lines) {
    text += IsTable(*value) ? fmt::format("{}\n{}", name, FormatTable(*value))
                            : fmt::format("{:<{}} {}\n", name, width, value->dump());
  }
  return text;
}

}  // namespace rigmap
