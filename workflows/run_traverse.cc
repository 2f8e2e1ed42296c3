#include "workflows/run_traverse.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "workflows/disk_space.h"
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

// What is about to happen, for people.
void Announce(const TraversePlan& plan, const PartRequest& part) {
  double seconds = 0.0;
  for (const PartJob& job : plan.jobs) seconds += EstimatedSeconds(job, part.threads);
  const int at_once = PartsAtOnce(plan, part.threads, part.memory_mb);
  fmt::print(stderr,
             "{} parts with {} pairs, {} at a time: about {:.0f} minutes and {:.1f} GB of disk\n",
             plan.jobs.size(), PairsOf(plan), at_once, std::ceil(seconds / 60.0),
             1e-3 * EstimatedDiskMegabytes(plan));
}

// The parts of a plan, several at the same time.
class Parts {
 public:
  Parts(const TraversePlan& plan, const RunRequest& request)
      : plan_(plan),
        request_(request),
        at_once_(PartsAtOnce(plan, request.part.threads, request.part.memory_mb)),
        failures_(plan.jobs.size()) {}

  // Why each could not be done; nothing of those that were. What is wrong with the request is
  // thrown once the parts at work have ended.
  std::vector<std::optional<std::string>> Do() && {
    std::vector<std::thread> others;
    for (int i = 1; i < at_once_; ++i) others.emplace_back([this] { Work(); });
    Work();
    for (std::thread& other : others) other.join();
    if (end_) std::rethrow_exception(end_);
    return std::move(failures_);
  }

 private:
  void Work() {
    while (const auto index = Next()) {
      try {
        DoPart(*index);
      } catch (...) {  // a wrong request, the same for every part, or worse
        const std::lock_guard lock(mutex_);
        end_ = std::current_exception();
        next_ = plan_.jobs.size();
      }
    }
  }

  std::optional<std::size_t> Next() {
    const std::lock_guard lock(mutex_);
    if (next_ >= plan_.jobs.size()) return std::nullopt;
    const PartJob& job = plan_.jobs[next_];
    if (!request_.part.quiet) {
      fmt::print(stderr, "part {} of {}: {}, {} pairs\n", next_ + 1, plan_.jobs.size(), job.name,
                 job.pairs);
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
        fmt::print(stderr, "part {} is not trusted by itself: {}\n", job.name, result.reason);
      }
    } catch (const UsageError&) {
      throw;
    } catch (const Error& error) {
      failures_[index] = fmt::format("part {} failed: {}", job.name, error.what());
      fmt::print(stderr, "{}\n", *failures_[index]);
    }
  }

  const TraversePlan& plan_;
  const RunRequest& request_;
  int at_once_;
  std::vector<std::optional<std::string>>
      failures_;  // each written by the thread that did the part
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::exception_ptr end_;
};

}  // namespace

PartResult RunTraverse(const RunRequest& request) {
  const TraversePlan plan = [&] {
    Job job(request.part.threads, request.part.quiet);
    return job.Run([&] { return PlanTraverse(request.plan); });
  }();
  const fs::path& out = request.part.out;
  RequireTraverseOutput(out);
  RequireDisk(plan, out);
  fs::create_directories(out / "parts");
  if (!request.part.quiet) Announce(plan, request.part);
  WriteFileAtomically(out / "plan.json", [&](std::ostream& stream) {
    stream << ToJson(plan, request.plan).dump(1) << "\n";
  });
  JoinRequest join{{}, request.part, request.use_rtk};
  Parts parts(plan, request);
  const auto failures = std::move(parts).Do();
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    if (failures[i]) {
      join.missing.push_back(*failures[i]);
    } else {
      join.outs.push_back(out / "parts" / plan.jobs[i].name);
    }
  }
  if (join.outs.empty()) {
    throw DataError(fmt::format("no part could be done; {}", join.missing.front()));
  }
  return JoinParts(join);
}

}  // namespace rigmap
