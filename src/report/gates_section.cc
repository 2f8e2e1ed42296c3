// Every check with its value, its limit and what it means; the parts of a traverse.
#include <fmt/format.h>

#include <algorithm>

#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

const char* StatusWords(const std::string& status) {
  return status == "ok"          ? "trusted"
         : status == "untrusted" ? "not trusted"
         : status == "failed"    ? "failed"
                                 : "not judged";
}

// What a gate judges, without the unit that its name ends with; empty for a name without one.
std::string ThingOf(const Json& gate) {
  const std::string name = TextAt(gate, "/name");
  for (const std::string unit : {"_deg", "_pct", "_px", "_sigmas"}) {
    if (name.ends_with(unit)) return name.substr(0, name.size() - unit.size());
  }
  return "";
}

bool IsBeyondLimit(const Json& gate) {
  const Json &value = At(gate, "/value"), &limit = At(gate, "/limit");
  return value.is_number() && limit.is_number() && value > limit;
}

// Beyond its limit, but one of two checks of one thing, of which the other holds.
bool IsPassedByTwin(const Json& gate, const Json& gates) {
  const std::string thing = ThingOf(gate);
  return !thing.empty() && IsBeyondLimit(gate) &&
         std::ranges::any_of(gates, [&](const Json& other) {
           return ThingOf(other) == thing && At(other, "/value").is_number() &&
                  !IsBeyondLimit(other);
         });
}

}  // namespace

std::string GatesSection(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  HtmlTable table({"Check", "Value", "Limit", "", "Means"});
  const Json& gates = At(summary.json, "/gates");
  for (std::size_t i = 0; i < gates.size(); ++i) {
    const std::string at = fmt::format("/gates/{}", i);
    const bool applies = HasFigure(summary, at + "/value");
    const bool passed = At(gates[i], "/passed") == Json(true);
    table.Row({fmt::format("<code>{}</code>", TextAt(gates[i], "/name")),
               Figure(summary, at + "/value", Quantity::kRatio),
               Figure(summary, at + "/limit", Quantity::kRatio),
               !applies ? "<span class=\"state\">does not apply</span>"
               : passed ? IsPassedByTwin(gates[i], gates)
                              ? "<span class=\"state ok\">passed by the other unit</span>"
                              : "<span class=\"state ok\">passed</span>"
                        : "<span class=\"state bad\">failed</span>",
               TextAt(gates[i], "/why")},
              applies && !passed ? "bad" : "");
  }
  return HtmlSection(
      "gates", "Checks",
      "A failed check means that the result contradicts itself or is not as good as "
      "asked. Of two that judge one thing in different units, passing one is enough.",
      table.Text());
}

std::string PartsSection(const PartContent& content) {
  HtmlTable table({"Part", "Verdict", "Path", "Scale, 95 %", "Worst position, 95 %", "Frames posed",
                   "Off the truth", ""});
  for (const PartOfTraverse& part : content.folder.parts) {
    const std::string name = "parts/" + part.name + "/summary";
    const std::string evaluated = "parts/" + part.name + "/evaluation";
    const FigureSource summary{name.c_str(), part.summary};
    const FigureSource evaluation{evaluated.c_str(), part.evaluation};
    const std::string status =
        part.summary.is_object() ? part.summary.value("status", "") : std::string();
    table.Row({fmt::format("<a href=\"parts/{0}/report.html\">{0}</a>", Escaped(part.name)),
               StatusWords(status), Figure(summary, "/verdict/known/path_m", Quantity::kMetres),
               Figure(summary, "/verdict/scale_95_pct", Quantity::kPercent),
               Figure(summary, "/verdict/position_95_m", Quantity::kMetres),
               Figure(summary, "/frames/posed", Quantity::kCount),
               Figure(evaluation, "/ate_se3_m", Quantity::kMetres),
               TextAt(part.summary, "/verdict/causes/0/brief")},
              status == "ok" ? "" : "bad");
  }
  return HtmlSection(
      "parts", "Parts",
      "What the traverse was put together from. Parts share frames, and each is "
      "judged by itself; the whole, adjusted at once, is better known than they. Their "
      "own pages open while this one lies in its folder.",
      table.Text());
}

}  // namespace rigmap
