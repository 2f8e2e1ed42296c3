#include "workflows/part_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/json_text.h"
#include "gates/accuracy.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/gates_report.h"

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
      {"matches", {{"keypoints_median", nullptr}, {"pairs", nullptr}, {"matches_median", nullptr}}},
      {"revisits", {{"pairs", nullptr}, {"by_appearance", nullptr}}},
      {"health",
       {{"lone_images", Report::array()},
        {"unreadable_images", Report::array()},
        {"remarks", Report::array()}}},
      {"rover",
       {{"wheel_scale", nullptr},
        {"wheel_scale_sigma", nullptr},
        {"gyro_bias_radps", nullptr},
        {"slips", Report::array()},
        {"visual_steps_refused", Report::array()}}},
      {"parts", Report::array()},
      {"worlds", Report::array()},
      {"mapping", {{"method", nullptr}, {"remarks", Report::array()}}},
      {"scale",
       {{"metres_per_model_unit", nullptr},
        {"relative_spread", nullptr},
        {"pairs_used", nullptr},
        {"pairs_rejected", Report::array()}}},
      {"rig",
       {{"refined", nullptr},
        {"parameters", nullptr},
        {"right_eye_turned_deg", nullptr},
        {"focal_changed_pct", nullptr},
        {"aspect_changed_pct", nullptr},
        {"largest_shift_px", nullptr},
        {"infinity_offset_px", nullptr},
        {"infinity_offset_sigma_px", nullptr},
        {"prior_factor", nullptr},
        {"lens_field_rms_px", nullptr},
        {"flexure_px", nullptr},
        {"given", nullptr},
        {"used", nullptr}}},
      {"map",
       {{"points", nullptr},
        {"frames", nullptr},
        {"voxel_m", nullptr},
        {"max_sigma_m", nullptr},
        {"max_sigma_pct", nullptr}}},
      {"gates", Report::array()},
      {"depth_consistency", nullptr},
      {"verdict",
       {{"text", nullptr},
        {"scale_95_pct", nullptr},
        {"position_95_m", nullptr},
        {"accuracy_asked_pct", nullptr},
        {"causes", Report::array()},
        {"usable", nullptr},
        {"known", nullptr}}},
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
std::string VerdictText(const Refusal& refusal, const Report& verdict) {
  if (verdict["text"].is_null()) return "";
  const std::string how_good = verdict["text"];
  if (refusal.causes.empty()) return how_good;
  const auto contradiction = std::ranges::find_if(refusal.causes, [](const Cause& cause) {
    return !std::ranges::all_of(cause.gates, IsAboutAccuracy, &Gate::name);
  });
  if (contradiction != refusal.causes.end()) {
    return fmt::format("inconsistent: {}; were it right: {}", contradiction->brief, how_good);
  }
  return fmt::format("consistent, but not as good as the {:.2g} % of the path asked for: {}",
                     verdict["accuracy_asked_pct"].get<double>(), how_good);
}

FrameNames NamesOfFrames(int first_frame, const Report& parts) {
  FrameNames names{first_frame};
  for (const Report& part : parts) {
    const int shared = part.at("shared_with_earlier");
    names.parts.push_back({part.at("name"), shared, part.at("frames").get<int>() - shared});
  }
  return names;
}

std::string ReasonFor(const Refusal& refusal) {
  std::vector<std::string> sentences;
  for (const Cause& cause : refusal.causes) sentences.push_back(SentenceOf(cause));
  return fmt::format("{}", fmt::join(sentences, "; "));
}

Report Describe(const std::vector<Cause>& causes) {
  Report list = Report::array();
  for (const Cause& cause : causes) {
    Report gates = Report::array();
    for (const Gate& gate : cause.gates) gates.push_back(gate.name);
    list.push_back({{"brief", cause.brief},
                    {"found", cause.found},
                    {"advice", cause.advice},
                    {"gates", std::move(gates)}});
  }
  return list;
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

PartResult Judge(const Ledger& ledger, int first_frame) {
  const Report merged = MergeReports(ledger);
  const JudgedPart judged = ReadJudged(merged);
  if (judged.gates.empty()) return {PartStatus::kPartial, "no gate checked yet", "", {}};
  Refusal refusal =
      RefusalOf(judged.gates, judged.findings, NamesOfFrames(first_frame, merged["parts"]));
  std::string text = VerdictText(refusal, merged["verdict"]);
  if (refusal.causes.empty()) return {PartStatus::kOk, "", std::move(text), {}};
  std::string reason = ReasonFor(refusal);
  return {PartStatus::kUntrusted, std::move(reason), std::move(text), std::move(refusal)};
}

std::string WriteSummary(const Ledger& ledger, const std::string& recipe,
                         const PartRequest& request, const std::string& failure) {
  const PartResult result = failure.empty() ? Judge(ledger, FirstFrame(request))
                                            : PartResult{PartStatus::kFailed, failure, "", {}};
  Report summary = {{"status", NameOf(result.status)},
                    {"reason", result.reason.empty() ? Report(nullptr) : Report(result.reason)},
                    {"technique", recipe}};
  const Report merged = MergeReports(ledger);
  summary["world_up"] = merged["world_up"];
  summary["stages"] = StagesOf(ledger);
  summary.update(merged);
  if (!result.verdict.empty()) summary["verdict"]["text"] = result.verdict;
  if (result.status == PartStatus::kUntrusted) {
    summary["verdict"]["causes"] = Describe(result.refusal.causes);
    summary["verdict"]["usable"] = result.refusal.usable;
  }
  summary["command"] = request.command;
  return JsonText(summary, 1) + "\n";
}

}  // namespace rigmap
