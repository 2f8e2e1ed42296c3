// Time and memory, options, versions, how to repeat it, what lies where.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

std::string StagesTable(const FigureSource& summary) {
  const Json& stages = At(summary.json, "/stages");
  double longest = 1e-9, all_s = 0.0, now_s = 0.0;
  for (const Json& stage : stages) longest = std::max(longest, stage.value("seconds", 0.0));
  HtmlTable table({"Stage", "Time", "", "Memory", ""});
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const std::string at = fmt::format("/stages/{}", i);
    const bool is_reused = At(stages[i], "/reused") == Json(true);
    all_s += stages[i].value("seconds", 0.0);
    now_s += is_reused ? 0.0 : stages[i].value("seconds", 0.0);
    table.Row({fmt::format("<code>{}</code>", TextAt(stages[i], "/name")),
               Figure(summary, at + "/seconds", Quantity::kSeconds),
               fmt::format("<span class=\"bar-of\" style=\"width:{:.1f}%\"></span>",
                           100.0 * stages[i].value("seconds", 0.0) / longest),
               Figure(summary, at + "/peak_rss_mb", Quantity::kMegabytes),
               is_reused ? "taken over from before" : ""});
  }
  if (table.empty()) return "";
  return fmt::format("<p>{} in all, of which {} in this run.</p>\n",
                     ShownNumber(all_s, Quantity::kSeconds),
                     ShownNumber(now_s, Quantity::kSeconds)) +
         table.Text();
}

std::string Options(const PartContent& content) {
  if (content.changed_options.empty())
    return "<p>None: all of config.yaml are defaults. What else was asked for is in the command "
           "below.</p>\n";
  std::string list;
  for (const std::string& option : content.changed_options) {
    list += fmt::format("<li><code>{}</code></li>\n", Escaped(option));
  }
  return "<ul>" + list + "</ul>\n";
}

std::string Files(const std::filesystem::path& root) {
  struct KnownFile {
    const char* name;
    const char* content;
  };
  constexpr std::array kFiles{
      KnownFile{"summary.json", "every number of this page that is not from elsewhere"},
      KnownFile{"evaluation.json", "errors against truth, fixes and survey"},
      KnownFile{"trajectory.tum", "poses, for other programs"},
      KnownFile{"trajectory.csv", "poses with sigmas, for spreadsheets"},
      KnownFile{"posegraph.g2o", "poses, steps and loop closures, for g2o and its like"},
      KnownFile{"sparse", "the adjusted points and poses, for COLMAP"},
      KnownFile{"dense.ply", "the map: open it in CloudCompare or MeshLab"},
      KnownFile{"dense.las", "the map, for a GIS and LAStools"},
      KnownFile{"height.tif", "heights from above, for a GIS"},
      KnownFile{"ortho.tif", "colours from above, for a GIS"},
      KnownFile{"terrain.tif", "slope, roughness and steps under a rover, for a GIS"},
      KnownFile{"georeference.json", "where the world lies on Earth"},
      KnownFile{"route.kml", "the route and rocks on Earth"},
      KnownFile{"rig_refined.yaml", "the corrected rig"},
      KnownFile{"config.yaml", "all options of this run"}};
  HtmlTable table({"File beside this page", "Holds"});
  for (const KnownFile& file : kFiles) {
    if (!std::filesystem::exists(root / file.name)) continue;
    table.Row({fmt::format("<a href=\"{0}\">{0}</a>", file.name), file.content});
  }
  return table.Text();
}

}  // namespace

std::string RunSection(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  const std::string command = TextAt(summary.json, "/command");
  const std::string colmap = TextAt(summary.json, "/versions/colmap");
  std::string body;
  if (const std::string stages = StagesTable(summary); !stages.empty()) {
    body += "<h3>Time and memory</h3>\n" + stages;
  }
  body += "<h3>Options that differ from the defaults</h3>\n" + Options(content);
  body += fmt::format("<h3>Versions</h3>\n<p>rigmap {}{}</p>\n",
                      TextAt(summary.json, "/versions/rigmap"),
                      colmap.empty() ? "" : ", COLMAP " + colmap);
  if (!command.empty()) {
    body += fmt::format("<h3>How to repeat it</h3>\n<pre>{}</pre>\n", command);
  }
  if (const std::string files = Files(content.folder.root); !files.empty()) {
    body += "<h3>Files</h3>\n" + files;
  }
  return HtmlSection("run", "How it was made",
                     "Equal data, options and version give equal results.", body);
}

}  // namespace rigmap
