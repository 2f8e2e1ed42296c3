#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "workflows/shell_word.h"
#include "workflows/traverse_plan.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

// Time limits are for the slowest machine of a cluster.
constexpr double kLimitOverEstimate = 4.0;
constexpr double kShortestLimit_min = 10.0;

std::vector<std::string> ArgumentsOf(const PartJob& job) {
  const DatasetRequest& d = job.dataset;
  std::vector<std::string> words{"--dataset", std::filesystem::absolute(d.folder).string()};
  const auto add = [&](const char* option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (d.traverse) add("--traverse", std::to_string(*d.traverse));
  if (d.part) add("--part", std::to_string(*d.part));
  if (d.rig) add("--rig", std::filesystem::absolute(*d.rig).string());
  if (d.format) add("--format", *d.format);
  if (d.frames) add("--frames", fmt::format("{}:{}", d.frames->first, d.frames->second));
  return words;
}

Json Describe(const PartData& part) {
  if (!IsUsable(part)) {
    return {{"name", part.name}, {"pairs", part.pairs}, {"remarks", part.remarks}};
  }
  Json gaps = Json::array();
  for (const auto& [after, seconds] : part.gaps) {
    gaps.push_back({{"after_pair", after}, {"seconds", seconds}});
  }
  return {{"name", part.name},
          {"format", part.format},
          {"pairs", part.pairs},
          {"image", {part.width, part.height}},
          {"rig", part.rig},
          {"baseline_m", part.baseline_m},
          {"first_s", part.first_s},
          {"last_s", part.last_s},
          {"interval_s", part.interval_s},
          {"gaps", std::move(gaps)},
          {"lone_images", part.lone_images},
          {"unreadable_images", part.unreadable_images},
          {"sensors",
           {{"inclinometer", part.inclinometer},
            {"wheels", part.wheels},
            {"inertial", part.inertial},
            {"fixes", part.fixes},
            {"rtk_fixed", part.rtk_fixed},
            {"surveyed_rocks", part.surveyed_rocks}}},
          {"remarks", part.remarks}};
}

int Minutes(const PartJob& job, int threads) {
  return static_cast<int>(std::ceil(EstimatedSeconds(job, threads) / 60.0));
}

}  // namespace

Json ToJson(const TraversePlan& plan, const PlanRequest& request) {
  Json json;
  json["dataset"] = std::filesystem::absolute(request.dataset.folder).string();
  for (const PartData& part : plan.parts) json["parts"].push_back(Describe(part));
  double minutes = 0.0;
  for (const PartJob& job : plan.jobs) {
    json["jobs"].push_back({{"name", job.name},
                            {"arguments", ArgumentsOf(job)},
                            {"pairs", job.pairs},
                            {"threads", request.threads},
                            {"memory_mb", std::round(EstimatedMegabytes(job, request.memory_mb))},
                            {"minutes", Minutes(job, request.threads)},
                            {"disk_mb", std::round(EstimatedDiskMegabytes(job))}});
    minutes += EstimatedSeconds(job, request.threads) / 60.0;
  }
  json["total"] = {
      {"pairs", PairsOf(plan)},
      {"minutes_one_after_the_other", std::ceil(minutes)},
      {"minutes_of_the_join", std::ceil(EstimatedJoinSeconds(plan, request.threads) / 60.0)},
      {"disk_mb", std::round(EstimatedDiskMegabytes(plan))}};
  return json;
}

std::string WriteSbatch(const TraversePlan& plan, const PlanRequest& request,
                        const std::vector<std::string>& part_arguments) {
  double megabytes = 0.0, seconds = 0.0;
  for (const PartJob& job : plan.jobs) {
    megabytes = std::max(megabytes, EstimatedMegabytes(job, request.memory_mb));
    seconds = std::max(seconds, EstimatedSeconds(job, request.threads));
  }
  std::string text = fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=rigmap\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --cpus-per-task={}\n"
      "#SBATCH --mem={:.0f}M\n"
      "#SBATCH --time={:.0f}\n"
      "# Results go to OUT (default: rigmap-out where this was submitted). The same job again "
      "goes\n"
      "# on from what is there. Afterwards: rigmap join \"$OUT\"/parts/* --out \"$OUT\"; where a\n"
      "# part failed, the folders of the others instead, and --missing \"part NAME failed\"\n",
      plan.jobs.size() - 1, request.threads, megabytes + 512.0,
      std::max(kShortestLimit_min, std::ceil(kLimitOverEstimate * seconds / 60.0)));
  for (const PartData& part : plan.parts) {
    if (IsUsable(part)) continue;
    text += fmt::format("# Part {} is left out: {}\n", part.name, part.remarks.back());
  }
  text += "set -eu\nOUT=${OUT:-$SLURM_SUBMIT_DIR/rigmap-out}\nnames=(";
  for (const PartJob& job : plan.jobs) text += fmt::format(" {}", ShellWord(job.name));
  text += " )\ncase $SLURM_ARRAY_TASK_ID in\n";
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    text += fmt::format("{}) arguments=(", i);
    std::vector<std::string> words = ArgumentsOf(plan.jobs[i]);
    if (const auto& truth = plan.jobs[i].truth) {
      words.insert(words.end(), {"--truth", std::filesystem::absolute(*truth).string()});
    }
    for (const std::string& word : words) text += fmt::format(" {}", ShellWord(word));
    text += " ) ;;\n";
  }
  text += "esac\nname=${names[$SLURM_ARRAY_TASK_ID]}\nmkdir -p \"$OUT/parts\"\n";
  std::string more;
  for (const std::string& word : part_arguments) more += fmt::format(" {}", ShellWord(word));
  // 3: made, and not to be trusted, which the join will say as well.
  text += fmt::format(
      "rigmap part \"${{arguments[@]}}\" --threads {} --memory {}{} --quiet \\\n"
      "  --out \"$OUT/parts/$name\" || [ $? -eq 3 ]\n",
      request.threads, request.memory_mb, more);
  return text;
}

}  // namespace rigmap
