// The first screen: whether to trust the result, the few figures that matter, the map from above.
#include <fmt/format.h>

#include <algorithm>

#include "report/html.h"
#include "report/part_content.h"
#include "report/pictures.h"

namespace rigmap {
namespace {

constexpr int kMapSide_px = 1400;

struct Standing {
  const char* css_class;
  const char* words;
  const char* advice;
};

Standing StandingOf(const Json& summary) {
  const std::string status = summary.value("status", "");
  if (status == "ok" && !At(summary, "/verdict/scale_95_pct").is_number()) {
    return {"partial", "Consistent, but nothing checked its metres",
            "It passed every check by which it could have contradicted itself. A rig that hardly "
            "moves shows nothing of its own metres: depths and map are as good as the rig file."};
  }
  if (status == "ok") {
    return {
        "ok", "This result can be trusted",
        "It passed every check by which it could have contradicted itself, and it is as good as "
        "was asked."};
  }
  if (status == "untrusted") {
    return {"untrusted", "Do not trust this result as it is", ""};
  }
  if (status == "failed") {
    return {"failed", "The run failed", "What lies in the folder is what was done before."};
  }
  return {"partial", "Not judged yet",
          "The run ended before the checks that tell whether it can be trusted."};
}

std::string Causes(const Json& summary) {
  std::string list;
  for (const Json& cause : At(summary, "/verdict/causes")) {
    list += fmt::format("<li>{}<br><em>To try next:</em> {}</li>\n", TextAt(cause, "/found"),
                        TextAt(cause, "/advice"));
  }
  if (list.empty()) return "";
  const std::string usable = TextAt(summary, "/verdict/usable");
  return fmt::format(
      "<h3>Why</h3><ul>{}</ul>{}", list,
      usable.empty() ? "" : fmt::format("<p><strong>Usable all the same:</strong> {}</p>", usable));
}

// A number and its per cent sign stay on one line.
std::string Together(const std::string& text) {
  std::string together;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool before_sign = text[i] == ' ' && i + 1 < text.size() && text[i + 1] == '%';
    together += before_sign ? "\u00a0" : std::string(1, text[i]);
  }
  return together;
}

std::string Verdict(const Json& summary) {
  const Standing standing = StandingOf(summary);
  std::string text = Together(TextAt(summary, "/verdict/text"));
  if (standing.css_class == std::string_view("failed")) text = TextAt(summary, "/reason");
  return fmt::format(
      "<div class=\"verdict {}\">\n<p class=\"headline\">{}</p>\n<p class=\"text\">{}</p>\n<p "
      "class=\"explain\">{}</p>\n{}</div>\n",
      standing.css_class, standing.words, text, standing.advice, Causes(summary));
}

std::string Tile(const char* name, const std::string& figure, const std::string& note) {
  return fmt::format(
      "<div class=\"tile\"><span class=\"name\">{}</span><strong>{}</strong>"
      "<span class=\"note\">{}</span></div>\n",
      name, figure, note);
}

std::string RockTile(const PartContent& content) {
  const FigureSource map = content.Map();
  if (!HasFigure(map, "/largest_rock/height_m")) return "";
  return Tile("Tallest rock", Figure(map, "/largest_rock/height_m", Quantity::kMetres) + " high",
              fmt::format("{} (95\u00a0%), {} wide; of {} things that stand out of the ground",
                          PlusMinus(map, "/largest_rock/height_95_m", Quantity::kMetres),
                          Figure(map, "/largest_rock/width_m", Quantity::kMetres),
                          Figure(map, "/rocks", Quantity::kCount)));
}

// Where a truth and what the result states of itself cannot both hold.
const char* Contradiction(const PartContent& content) {
  const FigureSource evaluation = content.folder.Evaluation(), summary = content.folder.Summary();
  if (!HasFigure(evaluation, "/scale_error_pct") || !HasFigure(summary, "/verdict/scale_95_pct")) {
    return "";
  }
  return At(evaluation.json, "/scale_error_pct") > At(summary.json, "/verdict/scale_95_pct")
             ? ", which is more than stated: this or the truth is wrong"
             : "";
}

std::string TruthTile(const PartContent& content) {
  const FigureSource evaluation = content.folder.Evaluation();
  if (HasFigure(evaluation, "/ate_se3_m")) {
    return Tile("Off the true path", Figure(evaluation, "/ate_se3_m", Quantity::kMetres),
                fmt::format("RMS, {} of the path; scale off by {}{}",
                            Figure(evaluation, "/ate_se3_pct", Quantity::kPercent),
                            Figure(evaluation, "/scale_error_pct", Quantity::kPercent),
                            Contradiction(content)));
  }
  if (HasFigure(evaluation, "/rms_se2_m")) {
    return Tile("Off the prism's track", Figure(evaluation, "/rms_se2_m", Quantity::kMetres),
                fmt::format("RMS, horizontal, {} of the path",
                            Figure(evaluation, "/rms_se2_pct", Quantity::kPercent)));
  }
  if (HasFigure(evaluation, "/rtk/rms_residual_m")) {
    return Tile("Off the RTK fixes", Figure(evaluation, "/rtk/rms_residual_m", Quantity::kMetres),
                fmt::format("RMS over {} fixes, horizontal",
                            Figure(evaluation, "/rtk/used", Quantity::kCount)));
  }
  return "";
}

std::string Tiles(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  std::string tiles;
  if (HasFigure(summary, "/verdict/known/path_m")) {
    tiles += Tile("Path driven", Figure(summary, "/verdict/known/path_m", Quantity::kMetres),
                  HasFigure(summary, "/verdict/scale_95_pct")
                      ? fmt::format("{} (95\u00a0%)",
                                    PlusMinus(summary, "/verdict/scale_95_pct", Quantity::kPercent))
                      : "scale not known");
  }
  if (HasFigure(summary, "/verdict/position_95_m")) {
    tiles += Tile("Worst position", PlusMinus(summary, "/verdict/position_95_m", Quantity::kMetres),
                  "95\u00a0%, relative to the start");
  }
  if (HasFigure(summary, "/frames/paired")) {
    tiles +=
        Tile("Frames posed",
             fmt::format("{} of {}", Figure(summary, "/frames/posed", Quantity::kCount),
                         Figure(summary, "/frames/paired", Quantity::kCount)),
             fmt::format("{} keyframes", Figure(summary, "/frames/keyframes", Quantity::kCount)));
  }
  tiles += RockTile(content) + TruthTile(content);
  if (HasFigure(content.Map(), "/median_sigma_m")) {
    tiles += Tile("Map", Figure(content.Map(), "/points", Quantity::kCount),
                  fmt::format("points, each {} (median) off its surface",
                              PlusMinus(content.Map(), "/median_sigma_m", Quantity::kMetres)));
  }
  return tiles.empty() ? "" : "<div class=\"tiles\">\n" + tiles + "</div>\n";
}

std::string MapFromAbove(const PartContent& content) {
  const std::string picture = PictureUrl(content.folder.root / "view_top.png", kMapSide_px, 82);
  if (!picture.empty()) {
    return fmt::format(
        "<figure class=\"above\"><img src=\"{}\" alt=\"The map from above with the path driven\">"
        "<figcaption>The map from above with the path driven. Up is the world's y; x is where the "
        "first camera looked.</figcaption></figure>\n",
        picture);
  }
  const std::string route = RouteDrawing(content);
  if (route.empty()) return "";
  return "<figure class=\"above\">" + route +
         "<figcaption>The path from above. There is no map.</figcaption></figure>\n";
}

}  // namespace

std::string VerdictSection(const PartContent& content) {
  const ResultFolder& folder = content.folder;
  const char* kind = folder.kind == ResultKind::kTraverse ? "traverse" : "part";
  return fmt::format(
      "<header id=\"top\">\n<p class=\"eyebrow\">rigmap \u00b7 {} \u00b7 technique {}</p>\n"
      "<h1>{}</h1>\n<div class=\"first\">\n<div>\n{}{}</div>\n{}</div>\n</header>\n",
      kind, TextAt(folder.summary, "/technique"), Escaped(folder.name), Verdict(folder.summary),
      Tiles(content), MapFromAbove(content));
}

}  // namespace rigmap
