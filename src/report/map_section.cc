// The map: the 3-D view with pictures in its stead, what it holds, and its rocks.
#include <fmt/format.h>

#include "report/bundle.h"
#include "report/html.h"
#include "report/part_content.h"
#include "report/pictures.h"

namespace rigmap {
namespace {

constexpr int kPictureSide_px = 1200;
constexpr std::size_t kMostRocks = 15;

std::string PictureOf(const PartContent& content, const char* file, const char* caption) {
  const std::string url = PictureUrl(content.folder.root / file, kPictureSide_px, 78);
  if (url.empty()) return "";
  return fmt::format(
      "<figure><img loading=\"lazy\" src=\"{}\" alt=\"{}\"><figcaption>{}"
      "</figcaption></figure>\n",
      url, caption, caption);
}

std::string RockTable(const PartContent& content) {
  const FigureSource map = content.Map();
  const Json& rocks = At(content.map, "/largest_rocks");
  HtmlTable table({"Rock", "Height above the ground", "Width", "x", "y"});
  for (std::size_t i = 0; i < rocks.size() && i < kMostRocks; ++i) {
    const std::string at = fmt::format("/largest_rocks/{}", i);
    table.Row({std::to_string(i + 1), Figure(map, at + "/height_m", Quantity::kMetres),
               Figure(map, at + "/width_m", Quantity::kMetres),
               Figure(map, at + "/x_m", Quantity::kMetres),
               Figure(map, at + "/y_m", Quantity::kMetres)});
  }
  if (table.empty()) return "";
  const std::string listed =
      rocks.size() > kMostRocks || At(content.map, "/rocks") > rocks.size()
          ? fmt::format("; of {} the tallest", Figure(map, "/rocks", Quantity::kCount))
          : "";
  return fmt::format(
      "<h3>Rocks, and whatever else stands out</h3><p>What rises steeply above the ground, a post "
      "or a wall as well as a rock, as far as the map shows it: of one seen from one side, that "
      "side{}.</p>{}",
      listed, table.Text());
}

}  // namespace

std::string ViewSection(const PartContent& content) {
  const std::string pictures =
      PictureOf(content, "view_oblique.png", "The map from aside, with the path driven") +
      PictureOf(content, "view_side.png", "The map from the side, with the path driven");
  const bool has_view = !ReportScripts().empty() &&
                        (!content.points.levels.empty() || content.folder.trajectory.size() > 1);
  if (!has_view && pictures.empty()) return "";
  std::string body;
  if (has_view) {
    body =
        "<div class=\"viewer\"><div class=\"bar\"></div><div class=\"stage\"></div></div>\n"
        "<p class=\"keys\">Drag to turn, right drag or two fingers to move, wheel or pinch to zoom "
        "to the pointer, double click to go to a point. Click a point for its height and a second "
        "one for the distance; click a camera for its image. Keys: arrows, <kbd>a</kbd> "
        "<kbd>d</kbd> turn, <kbd>+</kbd> <kbd>-</kbd>, <kbd>o</kbd> overview, <kbd>t</kbd> from "
        "above, <kbd>p</kbd> on the path, <kbd>f</kbd> fly, <kbd>Esc</kbd>. The sigma of a "
        "distance takes in the noise of both points, what the poses of the nearest cameras leave "
        "unknown between them, and the scale.</p>\n"
        "<p class=\"no-webgl\">This browser shows no WebGL: here are pictures instead.</p>\n";
  }
  return fmt::format(
      "<section id=\"view3d\"{}>\n<h2>The map in 3-D</h2>\n{}"
      "<div class=\"standin pictures\">{}</div></section>\n",
      has_view ? "" : " class=\"without-webgl plain\"", body, pictures);
}

std::string MapSection(const PartContent& content) {
  const FigureSource map = content.Map();
  if (!HasFigure(map, "/points")) return "";
  HtmlTable table({"What", "Value", "Means"});
  const auto row = [&](const char* name, const char* key, Quantity quantity, const char* meaning) {
    if (!HasFigure(map, key)) return;
    table.Row({name, Figure(map, key, quantity), meaning});
  };
  row("Points", "/points", Quantity::kCount, "in dense.ply");
  row("Points shown", "/points_shown", Quantity::kCount, "in this page, taken evenly from all");
  row("Finest voxel", "/finest_m", Quantity::kMetres,
      "side of the cubes in which measurements are merged on steep faces; twice as large on the "
      "ground (voxel_m of summary.json), coarser where less is known");
  const FigureSource summary = content.folder.Summary();
  const auto limit = [&](const char* name, const char* key, Quantity quantity) {
    if (!HasFigure(summary, key)) return;
    table.Row({name, Figure(summary, key, quantity), "what is known less well was left out"});
  };
  limit("Largest sigma", "/map/max_sigma_m", Quantity::kMetres);
  limit("Largest sigma, of the distance", "/map/max_sigma_pct", Quantity::kPercent);
  row("Sigma, median", "/median_sigma_m", Quantity::kMetres,
      "of one measurement off its surface, without errors that frames share");
  row("Overlap, median", "/median_images", Quantity::kCount, "left images that show a spot");
  row("Ground sample distance", "/pixel_m", Quantity::kMetres,
      "a pixel's width on the ground, in the nearest image of a spot, median");
  row("Observations, median", "/median_observations", Quantity::kCount,
      "depth pixels that were merged into a point");
  row("Ground covered", "/area_m2", Quantity::kRatio, "m\u00b2, cells of 2 cm with points");
  row("Density", "/points_per_m2", Quantity::kRatio, "points per m\u00b2 of that ground");
  return HtmlSection(
      "map", "What the map holds",
      "Made of depth that several frames agree upon. Colour the 3-D view by sigma to see where it "
      "is good, or by observations to see how much was merged into a point: far away, where points "
      "are coarse, that is much.",
      "<div class=\"pair\"><div>" + table.Text() + "</div>" + CellDrawings(content) + "</div>" +
          RockTable(content));
}

}  // namespace rigmap
