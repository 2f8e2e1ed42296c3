#include "workflows/verdict_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "gates/refusal.h"

namespace rigmap {
namespace {

using nlohmann::json;

std::string Standing(const json& summary) {
  const std::string status = summary.at("status");
  if (status == "untrusted") return "NOT TRUSTED";
  if (status != "ok") return "not judged yet";
  // Of a rig that stood, or one pair: nothing has shown how good the metres are.
  return summary.at("verdict").at("scale_95_pct").is_number() ? "TRUSTED" : "CONSISTENT";
}

std::string PathLine(const json& verdict) {
  const json& known = verdict.at("known");
  if (!known.is_object() || !known.at("path_m").is_number()) return "";
  std::string line = fmt::format("rigmap: path {:.2f} m", known.at("path_m").get<double>());
  if (verdict.at("scale_95_pct").is_number()) {
    line += fmt::format(" +- {:.2g} %", verdict.at("scale_95_pct").get<double>());
  }
  if (verdict.at("position_95_m").is_number()) {
    line += fmt::format(", worst position +- {} (95 %)",
                        LengthText(verdict.at("position_95_m").get<double>()));
  }
  return line + "\n";
}

std::string FramesPosed(const json& frames) {
  if (!frames.at("posed").is_number() || !frames.at("paired").is_number()) return "rigmap: ";
  return fmt::format("rigmap: {} of {} frames posed; ", frames.at("posed").get<int>(),
                     frames.at("paired").get<int>());
}

// Of parts that were joined, what each took is in its own summary.
std::string TimeTaken(const json& summary) {
  double seconds = 0.0, memory_mb = 0.0;
  const json* slowest = nullptr;
  for (const json& stage : summary.at("stages")) {
    memory_mb = std::max(memory_mb, stage.at("peak_rss_mb").get<double>());
    if (stage.value("reused", false)) continue;
    seconds += stage.at("seconds").get<double>();
    if (!slowest || stage.at("seconds") > slowest->at("seconds")) slowest = &stage;
  }
  if (!slowest) return "all taken from an earlier run\n";
  const bool is_joined = summary.contains("parts") && !summary.at("parts").empty();
  return fmt::format("{}took {:.0f} s and {:.0f} MB; longest {} with {:.0f} s\n",
                     is_joined ? "joining " : "", seconds, memory_mb,
                     slowest->at("name").get<std::string>(), slowest->at("seconds").get<double>());
}

}  // namespace

std::string VerdictLines(const std::filesystem::path& out) {
  try {
    const json summary = json::parse(ReadTextFile(out / "summary.json"));
    std::string lines;
    const json& text = summary.at("verdict").at("text");
    if (text.is_string()) {
      lines += fmt::format("rigmap: {}: {}\n", Standing(summary), Legible(text.get<std::string>()));
    }
    lines +=
        PathLine(summary.at("verdict")) + FramesPosed(summary.at("frames")) + TimeTaken(summary);
    if (std::filesystem::exists(out / "report.html")) {
      lines += fmt::format("rigmap: report: {}\n", (out / "report.html").string());
    }
    return lines;
  } catch (const std::exception&) {
    return "";
  }
}

}  // namespace rigmap
