#include "workflows/run_traverse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "core/console.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "core/json_text.h"
#include "workflows/disk_space.h"
#include "workflows/earlier_plan.h"
#include "workflows/join.h"
#include "workflows/output_folder.h"
#include "workflows/stages/satellite_fixes.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirstToJoin = "odometry";  // stage of a part

PartRequest RequestOf(const PartJob& job, const RunRequest& request) {
  PartRequest part = request.part;
  part.dataset = job.dataset;
  part.out = request.part.out / "parts" / job.name;
  part.truth = job.truth;
  part.until = request.part_until;
  part.from = request.part_from;
  return part;
}

// Whether the parts come as far as a join needs them.
bool CanBeJoined(const RunRequest& request) {
  if (!request.part_until) return true;
  const auto stages = StageNames(Technique::kRig);
  return std::ranges::find(stages, *request.part_until) >= std::ranges::find(stages, kFirstToJoin);
}

// What is about to happen, for people.
void Announce(const TraversePlan& plan, const RunRequest& request) {
  const PartRequest& part = request.part;
  double seconds = CanBeJoined(request) ? EstimatedJoinSeconds(plan, part.threads) : 0.0;
  for (const PartJob& job : plan.jobs) seconds += EstimatedSeconds(job, part.threads);
  const int at_once = PartsAtOnce(plan, part.threads, part.memory_mb);
  Say("{} parts with {} pairs, {} at a time: about {:.0f} minutes and {:.1f} GB of disk\n",
      plan.jobs.size(), PairsOf(plan), at_once, std::ceil(seconds / 60.0),
      1e-3 * EstimatedDiskMegabytes(plan));
}

struct PartFailure {
  std::string sentence;
  bool wrong_usage = false;
};

// The parts of a plan, several at the same time.
class Parts {
 public:
  Parts(const TraversePlan& plan, const RunRequest& request)
      : plan_(plan),
        request_(request),
        at_once_(PartsAtOnce(plan, request.part.threads, request.part.memory_mb)),
        failures_(plan.jobs.size()) {}

  std::vector<std::optional<PartFailure>> Do() && {
    std::vector<std::thread> others;
    for (int i = 1; i < at_once_; ++i) others.emplace_back([this] { Work(); });
    Work();
    for (std::thread& other : others) other.join();
    return std::move(failures_);
  }

 private:
  void Work() {
    while (const auto index = Next()) DoPart(*index);
  }

  std::optional<std::size_t> Next() {
    const std::lock_guard lock(mutex_);
    if (next_ >= plan_.jobs.size()) return std::nullopt;
    const PartJob& job = plan_.jobs[next_];
    if (!request_.part.quiet) {
      Say("part {} of {}: {}, {} pairs\n", next_ + 1, plan_.jobs.size(), job.name, job.pairs);
    }
    return next_++;
  }

  void DoPart(std::size_t index) {
    const PartJob& job = plan_.jobs[index];
    PartRequest part = RequestOf(job, request_);
    part.threads = std::max(1, part.threads / at_once_);
    part.sharing = at_once_;
    part.quiet = part.quiet || at_once_ > 1;  // whose bars would write over each other
    try {
      const PartResult result = ReconstructPart(part);
      if (result.status == PartStatus::kUntrusted) {
        Say("part {} is not trusted by itself: {}\n", job.name, result.reason);
      }
    } catch (const std::exception& error) {  // of whatever kind: the others can be done
      failures_[index] = {fmt::format("part {} failed: {}", job.name, ReasonOf(error)),
                          dynamic_cast<const UsageError*>(&error) != nullptr};
      Say("{}\n", failures_[index]->sentence);
    }
  }

  const TraversePlan& plan_;
  const RunRequest& request_;
  int at_once_;
  // Nothing of those that were done; each written by the thread that did the part.
  std::vector<std::optional<PartFailure>> failures_;
  std::mutex mutex_;
  std::size_t next_ = 0;
};

// Known to be wrong now, not when all work is done.
void RequireFixesOf(const TraversePlan& plan) {
  std::size_t fixes = 0;
  for (const PartData& part : plan.parts) fixes += static_cast<std::size_t>(part.fixes);
  for (const PartData& part : plan.parts) {
    if (IsUsable(part)) RequireFixes(part.rig, part.antenna, fixes);
  }
}

// The folders of the parts that were done, and what is missing. Throws where there is none.
JoinRequest WhatWasDone(const TraversePlan& plan,
                        const std::vector<std::optional<PartFailure>>& failures,
                        const RunRequest& request) {
  JoinRequest join{{}, request.part, request.use_rtk};
  for (const PartData& part : plan.parts) {
    if (IsUsable(part)) continue;
    join.missing.push_back(fmt::format("part {} failed: {}", part.name, part.remarks.back()));
  }
  bool wrong_usage = false;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    if (failures[i]) {
      join.missing.push_back(failures[i]->sentence);
      wrong_usage = wrong_usage || failures[i]->wrong_usage;
    } else {
      join.outs.push_back(request.part.out / "parts" / plan.jobs[i].name);
    }
  }
  if (!join.outs.empty()) return join;
  const std::string sentence = fmt::format("no part could be done; {}", join.missing.front());
  if (wrong_usage) throw UsageError(sentence);
  throw DataError(sentence);
}

// Before any part is removed: none holds what rigmap did not write.
void RequireRemovable(const TraversePlan& plan, const std::filesystem::path& out) {
  for (const auto& job : plan.jobs) RequireOwnOutput(out / "parts" / job.name, {}, true);
}

// Of parts that a join cannot take yet.
PartResult WithoutJoin(const JoinRequest& done) {
  if (!done.missing.empty()) throw DataError(fmt::format("{}", fmt::join(done.missing, "; ")));
  return {.status = PartStatus::kPartial,
          .reason = fmt::format("each part by itself: the join needs them up to {} or further",
                                kFirstToJoin),
          .summarised = false};
}

}  // namespace

PartResult RunTraverse(const RunRequest& request) {
  const TraversePlan plan = [&] {
    Job job(request.part.threads, request.part.quiet);
    return job.Run([&] { return PlanTraverse(request.plan); });
  }();
  if (request.use_rtk) RequireFixesOf(plan);
  const fs::path& out = request.part.out;
  RequireTraverseOutput(out);
  const auto planned = ToJson(plan, request.plan);
  if (request.part.force) {
    RequireRemovable(plan, out);
  } else {
    RequireSamePlan(out, planned);
  }
  RequireDisk(plan, out);
  const OutputLock lock(out / "parts");  // the join takes that of the whole
  if (request.part.force) RemovePartsBeside(out, planned);
  if (!request.part.quiet) Announce(plan, request);
  WriteFileAtomically(out / "plan.json",
                      [&](std::ostream& stream) { stream << JsonText(planned, 1) << "\n"; });
  const JoinRequest join = WhatWasDone(plan, Parts(plan, request).Do(), request);
  return CanBeJoined(request) ? JoinParts(join) : WithoutJoin(join);
}

}  // namespace rigmap
