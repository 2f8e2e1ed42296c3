#include "workflows/earlier_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "workflows/output_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Its name is that of a folder in parts/, which may come to be removed: no way out of it.
bool IsJob(const Json& job) {
  if (!job.is_object() || !job.contains("name") || !job["name"].is_string()) return false;
  const auto name = job["name"].get<std::string>();
  const auto arguments = job.value("arguments", Json::array());
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos &&
         arguments.is_array() &&
         std::ranges::all_of(arguments, [](const Json& word) { return word.is_string(); });
}

// Null where there is none that can be read.
Json EarlierPlan(const fs::path& out) {
  const fs::path path = out / "plan.json";
  if (!fs::exists(path)) return nullptr;
  Json plan = Json::parse(ReadTextFile(path), nullptr, false);
  const bool is_plan = plan.is_object() && plan.contains("parts") && plan.contains("jobs") &&
                       plan.value("dataset", Json("unknown")).is_string() &&
                       std::ranges::all_of(plan["jobs"], IsJob);
  return is_plan ? plan : Json(nullptr);
}

bool ShareAPart(const Json& plan, const Json& earlier) {
  return std::ranges::any_of(plan.at("parts"), [&](const Json& part) {
    if (!part.contains("first_s")) return false;  // of no use
    return std::ranges::any_of(earlier.at("parts"), [&](const Json& other) {
      return other.contains("first_s") && other["first_s"] == part["first_s"] &&
             other.contains("last_s") && other["last_s"] == part["last_s"];
    });
  });
}

// Names of jobs and their frames, empty for all of a part.
std::map<std::string, std::string> CutsOf(const Json& plan) {
  std::map<std::string, std::string> cuts;
  for (const Json& job : plan.at("jobs")) {
    const auto arguments = job.value("arguments", std::vector<std::string>());
    const auto frames = std::ranges::find(arguments, "--frames");
    const bool is_cut = frames != arguments.end() && frames + 1 != arguments.end();
    cuts[job.value("name", "")] = is_cut ? *(frames + 1) : "";
  }
  return cuts;
}

// The part of the data that a job is cut from.
std::string PartOf(const std::string& job) { return job.substr(0, job.find('.')); }

std::string Described(const std::string& name, const std::string& frames) {
  return frames.empty() ? name : fmt::format("{} of frames {}", name, frames);
}

}  // namespace

void RequireSamePlan(const fs::path& out, const Json& plan) {
  const Json earlier = EarlierPlan(out);
  if (earlier.is_null()) return;
  if (!ShareAPart(plan, earlier)) {
    throw DataError(fmt::format(
        "{}: holds a run of other data ({}) than those asked for ({}); choose another folder, or "
        "--force to remove it and start anew",
        out.string(), earlier.value("dataset", std::string("unknown")),
        plan.value("dataset", std::string("unknown"))));
  }
  const auto cuts = CutsOf(plan);
  for (const auto& [name, frames] : CutsOf(earlier)) {
    const auto now = cuts.find(name);
    if (now != cuts.end() && now->second == frames) continue;
    if (!MarkIn(out / "parts" / name)) continue;  // planned, not begun
    const auto instead =
        std::ranges::find(cuts, PartOf(name), [](const auto& cut) { return PartOf(cut.first); });
    if (instead == cuts.end()) continue;  // its data are of no use any more
    throw DataError(fmt::format(
        "{}: holds parts that were cut otherwise ({}) than those asked for ({}); choose another "
        "folder, or --force to remove them and start anew",
        out.string(), Described(name, frames), Described(instead->first, instead->second)));
  }
}

void RemovePartsBeside(const fs::path& out, const Json& plan) {
  const Json earlier = EarlierPlan(out);
  if (earlier.is_null()) return;
  const auto cuts = CutsOf(plan);
  for (const auto& [name, frames] : CutsOf(earlier)) {
    const fs::path part = out / "parts" / name;
    if (cuts.contains(name) || !MarkIn(part)) continue;
    const OutputLock lock(part);
    fs::remove_all(part);
  }
}

}  // namespace rigmap
