#include "workflows/part_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "gates/gates.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

// All keys in their order, for what no stage speaks of.
Report Blank() {
  return {{"world_up", nullptr},
          {"frames",
           {{"read", nullptr},
            {"paired", nullptr},
            {"keyframes", nullptr},
            {"registered", nullptr},
            {"posed", nullptr}}},
          {"revisits", {{"pairs", nullptr}, {"by_appearance", nullptr}}},
          {"health",
           {{"lone_images", Report::array()},
            {"unreadable_images", Report::array()},
            {"remarks", Report::array()}}},
          {"mapping", {{"method", nullptr}, {"remarks", Report::array()}}},
          {"scale",
           {{"metres_per_model_unit", nullptr},
            {"relative_spread", nullptr},
            {"pairs_used", 0},
            {"pairs_rejected", Report::array()}}},
          {"rig",
           {{"refined", nullptr},
            {"parameters", nullptr},
            {"right_eye_turned_deg", nullptr},
            {"focal_changed_pct", nullptr},
            {"largest_shift_px", nullptr},
            {"infinity_offset_px", nullptr},
            {"infinity_offset_sigma_px", nullptr}}},
          {"gates", Report::array()},
          {"depth_consistency", nullptr},
          {"verdict",
           {{"text", nullptr},
            {"scale_95_pct", nullptr},
            {"position_95_m", nullptr},
            {"accuracy_asked_pct", nullptr}}},
          {"versions", {{"rigmap", SourceVersion()}, {"colmap", nullptr}}}};
}

// Lists grow, objects are joined key by key, anything else takes the place of what was there.
void Merge(const Report& from, Report& into) {
  for (const auto& [key, value] : from.items()) {
    if (value.is_object() && into.contains(key) && into[key].is_object()) {
      Merge(value, into[key]);
    } else if (value.is_array() && into.contains(key) && into[key].is_array()) {
      into[key].insert(into[key].end(), value.begin(), value.end());
    } else {
      into[key] = value;
    }
  }
}

Gates ReadGates(const Report& list) {
  Gates gates;
  for (const Report& gate : list) {
    gates.push_back(
        {gate.at("name"),
         gate.at("value").is_null() ? std::nullopt : std::optional<double>(gate.at("value")),
         gate.at("limit"), gate.at("passed"), gate.at("why")});
  }
  return gates;
}

Report StagesOf(const Ledger& ledger) {
  Report stages = Report::array();
  for (const StageRecord& record : ledger.stages) {
    if (!record.listed) continue;
    stages.push_back({{"name", record.name},
                      {"seconds", record.seconds},
                      {"peak_rss_mb", record.peak_rss_mb},
                      {"reused", record.reused}});
  }
  return stages;
}

// The verdict as a surveyor would sign it: do the figures hold, and how good are they?
std::string VerdictText(const Gates& gates, const std::string& how_good, double asked_pct) {
  const auto is_accuracy = [](const Gate& gate) {
    return gate.name == "scale_95_pct" || gate.name == "position_95_pct";
  };
  const auto inconsistent = std::ranges::find_if(
      gates, [&](const Gate& gate) { return !gate.passed && !is_accuracy(gate); });
  if (inconsistent != gates.end()) {
    return fmt::format("inconsistent: {}; were it right: {}", inconsistent->why, how_good);
  }
  if (!AllPassed(gates)) {
    return fmt::format("consistent, but not as good as the {:.2g} % of the path asked for: {}",
                       asked_pct, how_good);
  }
  return how_good;
}

Gates GatesOf(const Ledger& ledger) {
  Gates gates;
  for (const StageRecord& record : ledger.stages) {
    if (!record.report.contains("gates")) continue;
    const Gates some = ReadGates(record.report["gates"]);
    gates.insert(gates.end(), some.begin(), some.end());
  }
  return gates;
}

}  // namespace

Report MergeReports(const Ledger& ledger) {
  Report merged = Blank();
  for (const StageRecord& record : ledger.stages) Merge(record.report, merged);
  // Some are known to be damaged from their names, others were read in vain.
  Report& unreadable = merged["health"]["unreadable_images"];
  const std::set<std::string> paths(unreadable.begin(), unreadable.end());
  unreadable = paths;
  return merged;
}

PartResult Judge(const Ledger& ledger) {
  const Gates gates = GatesOf(ledger);
  if (gates.empty()) return {PartStatus::kPartial, "no gate checked yet", ""};
  const Report verdict = MergeReports(ledger)["verdict"];
  std::string text;
  if (!verdict["text"].is_null()) {
    text = VerdictText(gates, verdict["text"], verdict["accuracy_asked_pct"]);
  }
  if (AllPassed(gates)) return {PartStatus::kOk, "", text};
  return {PartStatus::kUntrusted, FailureReason(gates), text};
}

std::string WriteSummary(const Ledger& ledger, const PartRequest& request,
                         const std::string& failure) {
  const PartResult result =
      failure.empty() ? Judge(ledger) : PartResult{PartStatus::kFailed, failure, ""};
  Report summary = {{"status", NameOf(result.status)},
                    {"reason", result.reason.empty() ? Report(nullptr) : Report(result.reason)},
                    {"technique", NameOf(request.technique)}};
  const Report merged = MergeReports(ledger);
  summary["world_up"] = merged["world_up"];
  summary["stages"] = StagesOf(ledger);
  summary.update(merged);
  if (!result.verdict.empty()) summary["verdict"]["text"] = result.verdict;
  summary["command"] = request.command;
  // Paths and other programs' words need not be UTF-8, as JSON must.
  return summary.dump(1, ' ', false, Report::error_handler_t::replace) + "\n";
}

}  // namespace rigmap
