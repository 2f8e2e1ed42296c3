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
  return {
      {"world_up", nullptr},
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
       {{"refined", nullptr}, {"right_eye_turned_deg", nullptr}, {"focal_changed_pct", nullptr}}},
      {"gates", Report::array()},
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
  Gates gates;
  for (const StageRecord& record : ledger.stages) {
    if (!record.report.contains("gates")) continue;
    const Gates some = ReadGates(record.report["gates"]);
    gates.insert(gates.end(), some.begin(), some.end());
  }
  if (gates.empty()) return {PartStatus::kPartial, "no gate checked yet"};
  if (AllPassed(gates)) return {};
  return {PartStatus::kUntrusted, FailureReason(gates)};
}

std::string WriteSummary(const Ledger& ledger, const PartRequest& request,
                         const std::string& failure) {
  const PartResult result =
      failure.empty() ? Judge(ledger) : PartResult{PartStatus::kFailed, failure};
  Report summary = {{"status", NameOf(result.status)},
                    {"reason", result.reason.empty() ? Report(nullptr) : Report(result.reason)},
                    {"technique", NameOf(request.technique)}};
  const Report merged = MergeReports(ledger);
  summary["world_up"] = merged["world_up"];
  summary["stages"] = StagesOf(ledger);
  summary.update(merged);
  summary["command"] = request.command;
  // Paths and other programs' words need not be UTF-8, as JSON must.
  return summary.dump(1, ' ', false, Report::error_handler_t::replace) + "\n";
}

}  // namespace rigmap
