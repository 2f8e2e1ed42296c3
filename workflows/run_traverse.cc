#include "workflows/run_traverse.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "workflows/join.h"
#include "workflows/output_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// What --truth means for one part: of a folder with one for each part its own.
std::optional<fs::path> TruthOfPart(const std::optional<fs::path>& truth, const PartJob& job) {
  if (!truth || !fs::is_directory(*truth) || fs::exists(*truth / "trajectory.tum")) return truth;
  const fs::path own = *truth / fmt::format("Part{}", job.dataset.part.value_or(1));
  return fs::exists(own / "trajectory.tum") ? std::optional(own) : std::nullopt;
}

PartRequest RequestOf(const PartJob& job, const RunRequest& request) {
  PartRequest part = request.part;
  part.dataset = job.dataset;
  part.out = request.part.out / "parts" / job.name;
  part.truth = TruthOfPart(request.part.truth, job);
  return part;
}

// False if it could not be done.
bool DoPart(const PartJob& job, const RunRequest& request, std::vector<std::string>& failures) {
  const PartRequest part = RequestOf(job, request);
  try {
    const PartResult result = ReconstructPart(part);
    if (result.status == PartStatus::kUntrusted) {
      fmt::print(stderr, "part {} is not trusted by itself: {}\n", job.name, result.reason);
    }
    return true;
  } catch (const UsageError&) {
    throw;  // the same for every part
  } catch (const Error& error) {
    failures.push_back(fmt::format("part {} failed: {}", job.name, error.what()));
    fmt::print(stderr, "{}\n", failures.back());
    return false;
  }
}

}  // namespace

PartResult RunTraverse(const RunRequest& request) {
  const TraversePlan plan = [&] {
    Job job(request.part.threads, request.part.quiet);
    return job.Run([&] { return PlanTraverse(request.plan); });
  }();
  const fs::path& out = request.part.out;
  RequireTraverseOutput(out);
  fs::create_directories(out / "parts");
  WriteFileAtomically(out / "plan.json", [&](std::ostream& stream) {
    stream << ToJson(plan, request.plan).dump(1) << "\n";
  });
  JoinRequest join{{}, request.part, request.use_rtk};
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const PartJob& job = plan.jobs[i];
    if (!request.part.quiet) {
      fmt::print(stderr, "part {} of {}: {}, {} pairs\n", i + 1, plan.jobs.size(), job.name,
                 job.pairs);
    }
    if (DoPart(job, request, join.missing)) join.outs.push_back(out / "parts" / job.name);
  }
  if (join.outs.empty()) {
    throw DataError(fmt::format("no part could be done; {}", join.missing.front()));
  }
  return JoinParts(join);
}

}  // namespace rigmap
