// Every number of evaluation.json: errors against a truth or fixes, and rocks.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "evaluation/step_figures.h"
#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

struct KnownKey {
  std::string_view key;
  const char* name;
};

constexpr std::array kKnownKeys{
    KnownKey{"frames", "Poses of the result"},
    KnownKey{"gt_frames", "Poses of the truth"},
    KnownKey{"coverage", "Share of true poses that are matched"},
    KnownKey{"path_m", "True path"},
    KnownKey{"est_path_m", "Path of the result"},
    KnownKey{"extent_m", "Largest distance from the start"},
    KnownKey{"ate_se3_m", "Distance from the true path, RMS, after a rigid motion"},
    KnownKey{"ate_sim3_m", "The same after a similarity, which hides an error of scale"},
    KnownKey{"ate_se3_pct", "Distance from the true path, of its length"},
    KnownKey{"scale", "Factor that would make the result right"},
    KnownKey{"scale_error_pct", "Error of the scale"},
    KnownKey{"segment_m", "Stretches of"},
    KnownKey{"rpe_t_pct", "Drift over a stretch, of its length"},
    KnownKey{"rpe_r_deg_per_m", "Drift of the direction, degrees per metre"},
    KnownKey{"inside", "Poses in the time of the track"},
    KnownKey{"rms_se2_m", "Distance from the track, RMS, horizontal, after a rigid motion"},
    KnownKey{"rms_se2_pct", "The same, of its length"},
    KnownKey{"max_se2_m", "Largest distance from the track"},
    KnownKey{"rms_sim2_m", "RMS after a similarity, which hides an error of scale"},
    KnownKey{"scale_truth_over_est", "Factor that would make the result right"},
    KnownKey{"lever", "Prism from the left camera, m: right, down, forward"},
    KnownKey{"lever_sim", "The same after a similarity, m"},
    KnownKey{"dt_s", "Clock of the track less that of the images"},
    KnownKey{"dt_sim", "The same after a similarity, s"},
    KnownKey{"truth_path_m", "Path of the track"},
    KnownKey{"height_rms_m", "Error of the height, RMS"},
    KnownKey{"height_drift_pct", "Slope of the height's error, of the path"},
    KnownKey{"used", "Fixes used"},
    KnownKey{"rejected", "Fixes rejected"},
    KnownKey{"rms_residual_m", "Distance of the fixes from the path, RMS, horizontal"},
    KnownKey{"ce90_m", "CE90: 90 in 100 fixes lie within, horizontally"},
    KnownKey{"le90_m", "LE90: 90 in 100 lie within, vertically"},
    KnownKey{"clock_offset_s", "Clock of the fixes less that of the images"},
    KnownKey{"clock_offset_sigma_s", "Sigma of that"},
    KnownKey{"heading_deg", "World's x from east, counterclockwise"},
    KnownKey{"expected", "Rocks that the map should show"},
    KnownKey{"found", "Rocks found"},
    KnownKey{"segmented", "Rocks in the map"},
    KnownKey{"unknown", "Of these, not in the survey"},
    KnownKey{"rocks", "Rocks"},
    KnownKey{"rtk", "RTK fixes"},
    KnownKey{"map", "The map over the true surface"},
    KnownKey{"map_sigmas", "How the map's sigmas hold"},
    KnownKey{"each", "Rock by rock"},
    KnownKey{"segments", "By length of the stretch"},
    KnownKey{"accuracy_median", "Median distance of the map from the surface"},
    KnownKey{"completeness_2cm", "Share of the visible surface within 2 cm of the map"}};

struct Suffix {
  std::string_view ending;
  Quantity quantity;
};
// The first that fits.
constexpr std::array kSuffixes{
    Suffix{"_deg_per_m", Quantity::kRatio},    Suffix{"latitude_deg", Quantity::kExact},
    Suffix{"longitude_deg", Quantity::kExact}, Suffix{"easting_m", Quantity::kExact},
    Suffix{"northing_m", Quantity::kExact},    Suffix{"_mm", Quantity::kMillimetres},
    Suffix{"_m", Quantity::kMetres},           Suffix{"_pct", Quantity::kPercent},
    Suffix{"_px", Quantity::kPixels},          Suffix{"_s", Quantity::kSeconds},
    Suffix{"_deg", Quantity::kDegrees},        Suffix{"coverage", Quantity::kShare}};

Quantity QuantityOf(std::string_view key, const Json& value) {
  for (const Suffix& suffix : kSuffixes) {
    if (key.ends_with(suffix.ending)) return suffix.quantity;
  }
  return value.is_number_integer() ? Quantity::kCount : Quantity::kRatio;
}

std::string Readable(const std::string& key) {
  for (const KnownKey& known : kKnownKeys) {
    if (known.key == key) return known.name;
  }
  std::string text = key;
  for (const char* unit : {"_deg", "_mm", "_m", "_pct", "_px", "_s"}) {
    if (text.ends_with(unit)) text.erase(text.size() - std::string_view(unit).size());
  }
  std::ranges::replace(text, '_', ' ');
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(text[0]));
  return Escaped(text);
}

std::string PointerStep(const std::string& key) {
  std::string step = "/";
  for (const char character : key) {
    step += character == '~' ? "~0" : character == '/' ? "~1" : std::string(1, character);
  }
  return step;
}

std::string CellOf(const FigureSource& source, const std::string& pointer, const std::string& key) {
  const Json& value = At(source.json, pointer);
  if (value.is_number()) return Figure(source, pointer, QuantityOf(key, value));
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return Escaped(value.get<std::string>());
  if (!value.is_array()) return Figure(source, pointer, Quantity::kRatio);
  std::string cells;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (i > 0) cells += ", ";
    cells += CellOf(source, fmt::format("{}/{}", pointer, i), key);
  }
  return cells;
}

// A list of objects as a table with a column for each key of the first.
std::string ListTable(const FigureSource& source, const std::string& pointer) {
  const Json& list = At(source.json, pointer);
  std::vector<std::string> keys;
  for (const Json& entry : list) {
    for (const auto& [key, value] : entry.items()) {
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    }
  }
  std::string headings, rows;
  for (const std::string& key : keys) headings += fmt::format("<th>{}</th>", Readable(key));
  for (std::size_t i = 0; i < list.size(); ++i) {
    rows += "<tr>";
    for (const std::string& key : keys) {
      const std::string at = fmt::format("{}/{}{}", pointer, i, PointerStep(key));
      rows += fmt::format("<td>{}</td>", CellOf(source, at, key));
    }
    rows += "</tr>\n";
  }
  return fmt::format(
      "<div class=\"table\"><table><thead><tr>{}</tr></thead><tbody>{}</tbody>"
      "</table></div>\n",
      headings, rows);
}

// A row for each step, of what tells them apart.
std::string StepsTable(const FigureSource& source, const std::string& pointer) {
  const Json& steps = At(source.json, pointer);
  std::vector<std::string> columns, headings{"After"};
  for (const std::string column : kStepFigures) {
    const Json::json_pointer key(fmt::format("/{}", column));
    if (std::ranges::none_of(steps, [&](const Json& step) { return step.contains(key); })) continue;
    columns.push_back(column);
    const bool is_rtk = column.starts_with("rtk/");
    headings.push_back(is_rtk ? "RTK: " + Readable(column.substr(4)) : Readable(column));
  }
  HtmlTable table(headings);
  for (const auto& [name, step] : steps.items()) {
    std::vector<std::string> cells{Readable(name)};
    for (const std::string& column : columns) {
      const std::string at = fmt::format("{}{}/{}", pointer, PointerStep(name), column);
      const Json& value = At(source.json, at);
      cells.push_back(value.is_null() ? "&ndash;" : CellOf(source, at, column));
    }
    table.Row(cells);
  }
  return table.Text();
}

bool IsListOfObjects(const Json& value) {
  return value.is_array() && !value.empty() && value[0].is_object();
}

// The values of an object, then what is in it, each under a heading of its own.
std::string ObjectTables(const FigureSource& source, const std::string& pointer, int depth) {
  HtmlTable table({"What", "Value"});
  std::string inner;
  for (const auto& [key, value] : At(source.json, pointer).items()) {
    const std::string at = pointer + PointerStep(key);
    const auto under = [&](const std::string& content) {
      return fmt::format("<h{0}>{1}</h{0}>\n{2}", std::min(depth + 3, 5), Readable(key), content);
    };
    if (key == "steps") {
      inner += fmt::format("<details><summary>What each step adds</summary>{}</details>\n",
                           StepsTable(source, at));
    } else if (value.is_object()) {
      inner += under(ObjectTables(source, at, depth + 1));
    } else if (IsListOfObjects(value)) {
      constexpr std::size_t kRowsAtOnce = 12;
      const std::string list = ListTable(source, at);
      inner += under(value.size() <= kRowsAtOnce
                         ? list
                         : fmt::format("<details><summary>{} rows</summary>{}</details>\n",
                                       value.size(), list));
    } else {
      table.Row({Readable(key), CellOf(source, at, key)});
    }
  }
  return table.Text() + inner;
}

// Where the world lies, and what the fixes leave open of that.
std::string GeoreferenceText(const FigureSource& earth) {
  if (!earth.json.is_object()) return "";
  std::string text = "<h3>On the Earth</h3>\n";
  if (At(earth.json, "/epsg").is_null()) {
    return text + fmt::format("<p>No place is given: {}.</p>\n", TextAt(earth.json, "/why"));
  }
  const auto metres = [&](const char* at) { return Figure(earth, at, Quantity::kMetres); };
  text += fmt::format(
      "<p>UTM zone {}, by fixes: one sigma is {} in the middle of the path, {} at the edge of the "
      "map and {} in height.</p>\n",
      TextAt(earth.json, "/utm_zone"), metres("/sigma/horizontal_m"), metres("/sigma/edge_m"),
      metres("/sigma/height_m"));
  const Json& weak = At(earth.json, "/weak");
  if (weak.empty()) return text;
  text += "<ul>";
  for (const Json& sentence : weak) {
    text += fmt::format("<li>{}</li>\n", Escaped(sentence.get<std::string>()));
  }
  return text + "</ul>\n";
}

}  // namespace

std::string EvaluationSection(const PartContent& content) {
  const FigureSource evaluation = content.folder.Evaluation();
  std::string body;
  if (evaluation.json.is_object()) body = ObjectTables(evaluation, "", 0);
  body += GeoreferenceText({"georeference", content.folder.georeference});
  if (body.empty()) return "";
  const bool ties = At(content.folder.summary, "/rtk_use/used") == Json(true);
  return HtmlSection(
      "evaluation", "Against what is known from elsewhere",
      std::string("Errors against the ground truth, the RTK fixes and the surveyed rocks, "
                  "which took no part in making the result") +
          (ties ? " (of the fixes those that did not tie it)" : "") +
          ": the numbers of evaluation.json.",
      body);
}

}  // namespace rigmap
