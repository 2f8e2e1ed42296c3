#include "workflows/stages/gates_report.h"

#include <cmath>

namespace rigmap {
namespace {

Report ToJson(const std::optional<double>& value) {
  return value ? Report(*value) : Report(nullptr);
}

Report ToJson(const std::vector<FrameRun>& ranges) {
  Report list = Report::array();
  for (const FrameRun& range : ranges) list.push_back({range.first, range.end});
  return list;
}

std::vector<FrameRun> RangesIn(const Report& list) {
  std::vector<FrameRun> ranges;
  for (const Report& range : list) ranges.push_back({range.at(0), range.at(1)});
  return ranges;
}

// Nothing also for what is not finite, whether it was written and read back or not.
std::optional<double> FromJson(const Report& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
  return value.get<double>();
}

}  // namespace

Report ReportGates(const Gates& gates) {
  Report list = Report::array();
  for (const Gate& gate : gates) {
    list.push_back({{"name", gate.name},
                    {"value", gate.value ? Report(*gate.value) : Report(nullptr)},
                    {"limit", gate.limit},
                    {"passed", gate.passed},
                    {"why", gate.why}});
  }
  return {{"gates", std::move(list)}};
}

Report ReportFindings(const PartFindings& findings) {
  const Accuracy& accuracy = findings.accuracy;
  return {
      {"scale_95_pct", ToJson(accuracy.scale_95_pct)},
      {"position_95_m", ToJson(accuracy.position_95_m)},
      {"accuracy_asked_pct", findings.accuracy_asked_pct},
      {"known",
       {{"path_m", accuracy.path_m},
        {"scale_95_pct_of_noise", ToJson(accuracy.noise_95_pct)},
        {"scale_95_pct_of_baseline", ToJson(accuracy.baseline_95_pct)},
        {"baseline_m", findings.baseline_m},
        {"rig_correction_px", ToJson(findings.rig_correction_px)},
        {"frames", findings.frames},
        {"guessed", ToJson(findings.guessed)},
        {"guessed_95_m",
         findings.guessed.empty() ? Report(nullptr) : ToJson(std::optional(findings.guessed_95_m))},
        {"breaks", findings.breaks},
        {"bridged", findings.bridged},
        {"pieces", ToJson(findings.pieces)}}}};
}

Gates ReadGates(const Report& report) {
  Gates gates;
  for (const Report& gate : report.at("gates")) {
    gates.push_back({gate.at("name"), FromJson(gate.at("value")), gate.at("limit"),
                     gate.at("passed"), gate.at("why")});
  }
  return gates;
}

JudgedPart ReadJudged(const Report& merged) {
  JudgedPart judged{.gates = ReadGates(merged), .findings = {}};
  const Report& verdict = merged.at("verdict");
  PartFindings& findings = judged.findings;
  Accuracy& accuracy = findings.accuracy;
  accuracy.scale_95_pct = FromJson(verdict.at("scale_95_pct"));
  accuracy.position_95_m = FromJson(verdict.at("position_95_m"));
  if (verdict.at("accuracy_asked_pct").is_number()) {
    findings.accuracy_asked_pct = verdict.at("accuracy_asked_pct");
  }
  const Report known = verdict.value("known", Report());
  if (!known.is_object()) return judged;
  accuracy.path_m = FromJson(known.at("path_m")).value_or(0.0);
  accuracy.noise_95_pct = FromJson(known.at("scale_95_pct_of_noise"));
  accuracy.baseline_95_pct = FromJson(known.at("scale_95_pct_of_baseline"));
  findings.baseline_m = known.at("baseline_m");
  findings.rig_correction_px = FromJson(known.at("rig_correction_px"));
  findings.frames = known.at("frames");
  findings.guessed = RangesIn(known.at("guessed"));
  findings.breaks = known.at("breaks").get<std::vector<int>>();
  findings.bridged = known.at("bridged").get<std::vector<int>>();
  findings.pieces = RangesIn(known.at("pieces"));
  return judged;
}

}  // namespace rigmap
