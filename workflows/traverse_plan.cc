#include "workflows/traverse_plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/error.h"
#include "core/memory_share.h"
#include "core/stamp.h"
#include "core/stamp_steps.h"
#include "workflows/plan_remarks.h"
#include "workflows/truth_files.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

double Seconds(StampNs stamp_ns) { return 1e-9 * static_cast<double>(stamp_ns); }

void FindGaps(const std::vector<StampNs>& stamps, PartData& findings) {
  const StampSteps steps = StepsOf(stamps);
  findings.interval_s = Seconds(steps.usual_ns);
  for (const std::size_t i : steps.gaps) {
    findings.gaps.emplace_back(static_cast<int>(i), Seconds(stamps[i + 1] - stamps[i]));
  }
}

PartData Examine(const Dataset& dataset, std::string name) {
  const Camera& camera = dataset.rig.left.camera;
  const DatasetHealth& health = dataset.health;
  PartData findings{
      .name = std::move(name),
      .pairs = static_cast<int>(dataset.frames.size()),
      .first_s = Seconds(dataset.frames.front().stamp_ns),
      .last_s = Seconds(dataset.frames.back().stamp_ns),
      .lone_images = static_cast<int>(health.lone_images.size()),
      .unreadable_images = static_cast<int>(health.unreadable_images.size()),
      .inclinometer = static_cast<int>(dataset.inclinometer.size()),
      .wheels = static_cast<int>(dataset.wheels.samples.size()),
      .inertial = static_cast<int>(dataset.inertial.samples.size()),
      .fixes = static_cast<int>(dataset.fixes.size()),
      .rtk_fixed = static_cast<int>(std::ranges::count(dataset.fixes, kRtkFixed, &GnssFix::status)),
      .surveyed_rocks = static_cast<int>(dataset.surveyed_landmarks.size()),
      .format = std::string(Name(dataset.format)),
      .rig = dataset.rig.source,
      .antenna = dataset.rig.antenna_in_left.has_value(),
      .width = camera.width,
      .height = camera.height,
      .baseline_m = dataset.rig.Baseline(),
      .remarks = health.remarks};
  for (const std::string& problem : {dataset.wheels.problem, dataset.inertial.problem}) {
    if (!problem.empty() && !std::ranges::count(findings.remarks, problem)) {
      findings.remarks.push_back(problem);
    }
  }
  std::vector<StampNs> stamps;
  for (const StereoFrame& frame : dataset.frames) stamps.push_back(frame.stamp_ns);
  FindGaps(stamps, findings);
  for (const auto& more : {RemarksOnStamps(stamps), RemarksOnFixes(dataset.fixes)}) {
    findings.remarks.insert(findings.remarks.end(), more.begin(), more.end());
  }
  return findings;
}

// Of the parts that can be used, each beside the one that begins before it.
void RemarkOnPauses(std::vector<PartData>& parts) {
  std::vector<PartData*> in_order;
  for (PartData& part : parts) {
    if (IsUsable(part)) in_order.push_back(&part);
  }
  std::ranges::stable_sort(in_order, {}, &PartData::first_s);
  for (std::size_t i = 1; i < in_order.size(); ++i) {
    const PartData& earlier = *in_order[i - 1];
    PartData& later = *in_order[i];
    std::string remark =
        RemarkOnNeighbours({earlier.name, earlier.first_s, earlier.last_s},
                           {later.name, later.first_s, later.last_s}, kGapSteps * later.interval_s);
    if (!remark.empty()) later.remarks.push_back(std::move(remark));
  }
}

std::string PartName(const DatasetRequest& part) {
  return part.part ? std::to_string(*part.part) : "1";
}

// All parts that can be used, the others with why not. Throws what the first is unusable for, where
// all are.
std::vector<PartData> ExamineParts(const std::vector<DatasetRequest>& parts) {
  std::vector<PartData> findings;
  std::exception_ptr unusable;
  for (const DatasetRequest& part : parts) {
    try {
      findings.push_back(Examine(OpenDataset(part), PartName(part)));
    } catch (const DataError& error) {
      if (!unusable) unusable = std::current_exception();
      findings.push_back({.name = PartName(part), .remarks = {error.what()}});
    }
  }
  if (std::ranges::none_of(findings, IsUsable)) std::rethrow_exception(unusable);
  for (const PartData& part : findings) {
    if (!IsUsable(part)) spdlog::warn("part {} is left out: {}", part.name, part.remarks.back());
  }
  RemarkOnPauses(findings);
  return findings;
}

// How many jobs each part becomes: `split` in all, the longest cut first.
std::vector<int> PiecesOf(const std::vector<PartData>& parts, const PlanRequest& request) {
  std::vector<int> pieces(parts.size(), 1);
  for (std::size_t p = 0; p < parts.size() && request.max_frames; ++p) {
    pieces[p] = PiecesOfAtMost(*request.max_frames, parts[p].pairs, request.overlap);
  }
  if (!request.split) return pieces;
  const auto usable = std::ranges::count_if(parts, IsUsable);
  if (*request.split < usable) {
    throw UsageError(fmt::format("--split {}: expected at least {}, the number of parts found",
                                 *request.split, usable));
  }
  const auto length = [&](std::size_t p) {
    return static_cast<double>(parts[p].pairs) / pieces[p];
  };
  pieces.assign(parts.size(), 1);
  for (auto more = *request.split - usable; more > 0; --more) {
    std::size_t longest = 0;
    for (std::size_t p = 1; p < parts.size(); ++p) {
      if (length(p) > length(longest)) longest = p;
    }
    ++pieces[longest];
  }
  return pieces;
}

// Cuts a part into equal pieces, of which each reaches into the next by the overlap.
void AddJobs(const DatasetRequest& part, const PartData& findings, int pieces,
             const PlanRequest& request, std::vector<PartJob>& jobs) {
  const double megapixels = 1e-6 * findings.width * findings.height;
  const std::string folder = part.folder.string();
  const auto truth = TruthOfPart(request.truth, part);
  if (pieces == 1) {
    jobs.push_back({PartName(part), part, findings.pairs, megapixels, folder, truth});
    return;
  }
  // A job must have frames of its own beside those that it shares at both ends.
  const int least = pieces * (request.overlap + 1) + request.overlap;
  if (findings.pairs < least) {
    const auto asked = request.max_frames ? fmt::format("--max-frames {}", *request.max_frames)
                                          : fmt::format("--split {}", *request.split);
    throw UsageError(fmt::format(
        "{}: expected at least {} pairs for {} jobs that share {} frames, found {} in part {}",
        asked, least, pieces, request.overlap, findings.pairs, findings.name));
  }
  const int first = part.frames ? part.frames->first : 0;
  const int digits = static_cast<int>(std::to_string(pieces).size());
  const auto cuts = CutEvenly(findings.pairs, pieces, request.overlap);
  for (int i = 0; i < pieces; ++i) {
    const auto [begin, end] = cuts[static_cast<std::size_t>(i)];
    PartJob job{fmt::format("{}.{:0{}}", PartName(part), i + 1, digits),
                part,
                end - begin,
                megapixels,
                folder,
                truth};
    job.dataset.frames = {first + begin, first + end};
    jobs.push_back(std::move(job));
  }
}

}  // namespace

int PiecesOfAtMost(int max_pairs, int pairs, int overlap) {
  const int own = max_pairs - overlap;  // of each piece, beside what it shares with the next
  return std::max(1, (pairs - overlap + own - 1) / own);
}

std::vector<std::pair<int, int>> CutEvenly(int pairs, int pieces, int overlap) {
  const auto begin = [&](int piece) {
    return static_cast<int>((std::int64_t{pairs - overlap} * piece + pieces - 1) / pieces);
  };
  std::vector<std::pair<int, int>> cuts;
  for (int i = 0; i < pieces; ++i) cuts.emplace_back(begin(i), begin(i + 1) + overlap);
  return cuts;
}

TraversePlan PlanTraverse(const PlanRequest& request) {
  if (request.overlap < 1) {
    throw UsageError(fmt::format("--overlap: expected 1 or more, found {}", request.overlap));
  }
  if (request.split && request.max_frames) {
    throw UsageError("--split and --max-frames: expected one of them, found both");
  }
  if (request.max_frames && *request.max_frames <= 2 * request.overlap) {
    throw UsageError(
        fmt::format("--max-frames: expected more than twice the overlap of {}, found {}",
                    request.overlap, *request.max_frames));
  }
  const std::vector<DatasetRequest> parts = PartsOf(request.dataset);
  TraversePlan plan{.parts = ExamineParts(parts)};
  const std::vector<int> pieces = PiecesOf(plan.parts, request);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (IsUsable(plan.parts[p])) AddJobs(parts[p], plan.parts[p], pieces[p], request, plan.jobs);
  }
  return plan;
}

int PairsOf(const TraversePlan& plan) {
  int pairs = 0;
  for (const PartJob& job : plan.jobs) pairs += job.pairs;
  return pairs;
}

double EstimatedSeconds(const PartJob& job, int threads) {
  // Seconds of one thread for a pair of one megapixel, from the rendered and the real drives; small
  // images cost somewhat more each.
  constexpr double kPerMegapixel = 2.2, kPerPair = 0.3, kOnce = 5.0;
  return kOnce + job.pairs * (kPerPair + kPerMegapixel * job.megapixels) / threads;
}

double EstimatedJoinSeconds(const TraversePlan& plan, int threads) {
  // What is left of the time of whole traverses beside that of their parts.
  constexpr double kPerMegapixel = 0.6, kPerPair = 0.3, kOnce = 5.0;
  double seconds = kOnce;
  for (const PartJob& job : plan.jobs) {
    seconds += job.pairs * (kPerPair + kPerMegapixel * job.megapixels) / threads;
  }
  return seconds;
}

double EstimatedMegabytes(const PartJob& job, int memory_mb) {
  // Correspondences and sums of the adjustment grow with the pairs; depth is bounded by --memory.
  constexpr double kPerPair = 1.0;
  return std::max<double>(memory_mb, kProgramMegabytes + kPerPair * job.pairs);
}

int PartsAtOnce(const TraversePlan& plan, int threads, int memory_mb) {
  constexpr double kPerPair = 1.0, kPerMegapixel = 250.0;  // of one thread
  double needed_mb = 1.0;
  for (const PartJob& job : plan.jobs) {
    needed_mb = std::max(needed_mb,
                         kProgramMegabytes + kPerPair * job.pairs + kPerMegapixel * job.megapixels);
  }
  const int fitting = static_cast<int>(memory_mb / needed_mb);
  return std::clamp(std::min(threads, fitting), 1, std::max(1, static_cast<int>(plan.jobs.size())));
}

double EstimatedDiskMegabytes(const PartJob& job) {
  // Features, depth and points of a pair.
  constexpr double kPerPair = 3.5, kPerMegapixel = 5.0;
  return job.pairs * (kPerPair + kPerMegapixel * job.megapixels);
}

double EstimatedDiskMegabytes(const TraversePlan& plan) {
  constexpr double kPerPairOfWhole = 2.5;
  double megabytes = 0.0;
  for (const PartJob& job : plan.jobs) {
    megabytes += EstimatedDiskMegabytes(job) + kPerPairOfWhole * job.pairs;
  }
  return megabytes;
}

}  // namespace rigmap
