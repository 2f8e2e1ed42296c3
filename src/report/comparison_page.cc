// A comparison: who can be trusted, who is nearest to the truth, the routes over each other, and
// the figures that tools/plot-comparison has drawn.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>

#include "core/error.h"
#include "core/file.h"
#include "export/tum.h"
#include "report/base64.h"
#include "report/drawing.h"
#include "report/html.h"
#include "report/page.h"
#include "report/result_folder.h"

namespace rigmap {
namespace {

struct ComparedColumn {
  const char* key;
  const char* name;
  Quantity quantity;
};

// Those that matter most first; a column is shown where any run has it.
constexpr std::array kComparedColumns{
    ComparedColumn{"ate_se3_pct", "Off the true path", Quantity::kPercent},
    ComparedColumn{"scale_error_pct", "Scale error", Quantity::kPercent},
    ComparedColumn{"scale_95_pct", "Scale known to, 95 %", Quantity::kPercent},
    ComparedColumn{"position_95_m", "Positions known to, 95 %", Quantity::kMetres},
    ComparedColumn{"coverage_pct", "Frames not guessed", Quantity::kPercent},
    ComparedColumn{"f_1cm_within_1.5m", "Map within 1 cm, to 1.5 m", Quantity::kRatio},
    ComparedColumn{"f_1cm_within_3.5m", "Map within 1 cm, to 3.5 m", Quantity::kRatio},
    ComparedColumn{"rocks_found", "Rocks found", Quantity::kCount},
    ComparedColumn{"rock_shift_mm", "Rocks shifted", Quantity::kMillimetres},
    ComparedColumn{"rtk_rms_m", "Off the RTK fixes", Quantity::kMetres},
    ComparedColumn{"drift_10m_pct", "Drift over 10 m", Quantity::kPercent},
    ComparedColumn{"drift_100m_pct", "Drift over 100 m", Quantity::kPercent},
    ComparedColumn{"seconds", "Time", Quantity::kSeconds},
    ComparedColumn{"peak_rss_mb", "Memory", Quantity::kMegabytes}};

std::vector<ComparedColumn> ColumnsThatAreThere(const Json& rows) {
  std::vector<ComparedColumn> columns;
  for (const ComparedColumn& column : kComparedColumns) {
    const auto has = [&](const Json& row) {
      return row.contains(column.key) && row[column.key].is_number();
    };
    if (std::ranges::any_of(rows, has)) columns.push_back(column);
  }
  return columns;
}

std::string StatusOfRow(const Json& row) {
  const std::string status = row.value("status", "");
  if (status == "ok") return "<span class=\"state ok\">trusted</span>";
  return fmt::format("<span class=\"state bad\">{}</span>",
                     status == "untrusted" ? "not trusted" : Escaped(status));
}

std::string NameOfRow(const Json& row) {
  std::string name = TextAt(row, "/technique");
  if (const std::string setting = TextAt(row, "/setting"); !setting.empty()) name += " " + setting;
  if (row.value("repeat", 0) > 0) name += fmt::format(" ({})", row.value("repeat", 0));
  return name;
}

std::string RowsTable(const FigureSource& source) {
  const Json& rows = At(source.json, "/rows");
  const auto columns = ColumnsThatAreThere(rows);
  std::string headings = "<th>Run</th><th></th>", lines;
  for (const ComparedColumn& column : columns) {
    headings += fmt::format("<th>{}</th>", column.name);
  }
  headings += "<th>Why not</th>";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string run = TextAt(rows[i], "/run");
    lines += fmt::format(
        "<tr><td><a href=\"{}/report.html\">{}</a><br><small>{}</small></td>"
        "<td>{}</td>",
        run, NameOfRow(rows[i]), TextAt(rows[i], "/part"), StatusOfRow(rows[i]));
    for (const ComparedColumn& column : columns) {
      lines += fmt::format("<td>{}</td>", Figure(source, fmt::format("/rows/{}/{}", i, column.key),
                                                 column.quantity));
    }
    lines += fmt::format("<td class=\"text\">{}</td></tr>\n", TextAt(rows[i], "/reason"));
  }
  return fmt::format(
      "<div class=\"table\"><table class=\"wide\"><thead><tr>{}</tr></thead><tbody>{}"
      "</tbody></table></div>\n",
      headings, lines);
}

struct ComparedRoute {
  std::string name;
  std::vector<Eigen::Vector2d> points;
};

std::vector<ComparedRoute> RoutesOf(const ResultFolder& folder, const std::string& part) {
  std::vector<ComparedRoute> routes;
  for (const Json& row : folder.comparison["rows"]) {
    if (row.value("part", "") != part || !row.contains("run") || !row["run"].is_string()) continue;
    const auto tum = folder.root / row["run"].get<std::string>() / "trajectory.tum";
    try {
      ComparedRoute route{NameOfRow(row), {}};
      for (const TumPose& pose : ReadTum(tum)) {
        route.points.emplace_back(pose.world_from_body.translation.head<2>());
      }
      routes.push_back(std::move(route));
    } catch (const DataError&) {
      continue;  // of a run that failed
    }
  }
  return routes;
}

constexpr std::size_t kLineColours = 8;

std::string DrawRoutes(const std::vector<ComparedRoute>& routes) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(INFINITY), high = -low;
  for (const ComparedRoute& route : routes) {
    for (const Eigen::Vector2d& point : route.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  if (!low.allFinite()) return "";
  const DrawingFrame frame(low, high, 1140.0, 480.0);
  std::string drawn, legend;
  for (std::size_t i = 0; i < routes.size(); ++i) {
    std::vector<Eigen::Vector2d> mapped;
    for (const Eigen::Vector2d& point : routes[i].points) mapped.push_back(frame(point));
    const std::string colour = fmt::format("line-{}", i % kLineColours);
    drawn += DrawLine(mapped, colour.c_str());
    legend += fmt::format("<span><i class=\"key {}\"></i>{}</span>", colour, routes[i].name);
  }
  return "<figure>" +
         DrawingText(frame.width_px(), frame.height_px(), "routes from above",
                     drawn + frame.ScaleBar()) +
         "<p class=\"legend-line\">" + legend + "</p></figure>\n";
}

std::string Routes(const ResultFolder& folder) {
  std::set<std::string> parts;
  for (const Json& row : folder.comparison["rows"]) parts.insert(row.value("part", ""));
  std::string body;
  for (const std::string& part : parts) {
    const std::string drawing = DrawRoutes(RoutesOf(folder, part));
    if (!drawing.empty()) body += fmt::format("<h3>{}</h3>\n{}", Escaped(part), drawing);
  }
  return HtmlSection("routes", "Routes",
                     "From above, each in its own world: all begin at the same first camera, its "
                     "heading is x.",
                     body);
}

// Larger ones, whose maps hold whole pictures, would make the page too heavy.
constexpr std::uintmax_t kMostFigureBytes = 4U << 20U;

// The text of a figure as tools/plot-comparison leaves it; empty for any other file, for one with a
// script in it, and for one that cannot be read.
std::string FigureText(const std::filesystem::path& path) {
  std::error_code ignored;
  if (path.extension() != ".svg" || !std::filesystem::is_regular_file(path, ignored) ||
      std::filesystem::is_symlink(path, ignored) ||
      std::filesystem::file_size(path, ignored) > kMostFigureBytes) {
    return "";
  }
  try {
    std::string text = ReadTextFile(path);
    std::string lower = text;
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const bool is_ours = lower.find("<dc:title>rigmap plot-comparison</dc:title>") != lower.npos;
    const bool is_plain =
        lower.find("<script") == lower.npos && lower.find("javascript:") == lower.npos;
    return is_ours && is_plain ? text : "";
  } catch (const DataError&) {
    return "";
  }
}

// In the page, but as pictures: whatever stands in them, they run nothing, load nothing and share
// no names with the page.
std::string Figures(const ResultFolder& folder) {
  std::set<std::filesystem::path> paths;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder.root / "plots", ignored)) {
    paths.insert(entry.path());
  }
  std::string body;
  for (const auto& path : paths) {
    const std::string text = FigureText(path);
    if (text.empty()) continue;
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    const std::string name = Escaped(path.stem().string());
    body += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/svg+xml;base64,{1}\">"
        "<figcaption>{0}</figcaption></figure>\n",
        name, Base64(bytes));
  }
  return HtmlSection("figures", "Figures", "As <code>tools/plot-comparison</code> has drawn them.",
                     body);
}

std::string Headline(const Json& comparison) {
  std::size_t trusted = 0, refused = 0, failed = 0;
  const Json& rows = comparison["rows"];
  for (const Json& row : rows) {
    const std::string status = row.value("status", "");
    ++(status == "ok" ? trusted : status == "untrusted" ? refused : failed);
  }
  // Of trusted ones the nearest to the truth; without a truth those that know their scale best.
  std::string best;
  for (const char* key : {"ate_se3_pct", "scale_95_pct"}) {
    const Json* found = nullptr;
    for (const Json& row : rows) {
      if (row.value("status", "") != "ok" || !row.contains(key) || !row[key].is_number()) continue;
      if (!found || row[key] < (*found)[key]) found = &row;
    }
    if (!found) continue;
    best = fmt::format("Of the trusted ones <strong>{}</strong> {}.", NameOfRow(*found),
                       std::string_view(key) == "ate_se3_pct" ? "is nearest to the truth"
                                                              : "knows its scale best");
    break;
  }
  return fmt::format(
      "<div class=\"verdict {}\"><p class=\"headline\">{} of {} runs can be trusted</p>\n<p>{} not "
      "trusted, {} failed. {}</p></div>\n",
      trusted > 0 ? "ok" : "untrusted", trusted, rows.size(), refused, failed, best);
}

}  // namespace

Page ComparisonPage(const ResultFolder& folder) {
  const FigureSource source{"comparison", folder.comparison};
  Page page{.title = fmt::format("{} \u00b7 rigmap", folder.name)};
  page.sections.push_back(fmt::format(
      "<header id=\"top\">\n<p class=\"eyebrow\">rigmap \u00b7 comparison</p>\n<h1>{}</h1>\n{}{}"
      "</header>\n",
      Escaped(folder.name), Headline(folder.comparison), RowsTable(source)));
  for (std::string section : {Routes(folder), Figures(folder)}) {
    if (!section.empty()) page.sections.push_back(std::move(section));
  }
  page.data = Json::object();
  return page;
}

}  // namespace rigmap
