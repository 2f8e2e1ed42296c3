// What a traverse's data are, and the jobs that its parts make.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dataset/open_dataset.h"

namespace rigmap {

struct PlanRequest {
  DatasetRequest dataset;             // of a traverse: part and frames may be left out
  std::optional<int> split;           // jobs in all; nothing: one for each part of the data
  std::optional<int> max_frames;      // of a job, those that it shares among them
  int overlap = 10;                   // frames that jobs cut from one part have in common
  int threads = 2, memory_mb = 2048;  // of a job
  // Of all parts, or a folder with PartN/trajectory.tum for each.
  std::optional<std::filesystem::path> truth = {};
};

// One `rigmap part`, which needs to know nothing of the others.
struct PartJob {
  std::string name;        // of its folder
  DatasetRequest dataset;  // with its frames, where the part was cut
  int pairs = 0;
  double megapixels = 0.0;  // of an image
  std::string folder;       // of its files, for people
  std::optional<std::filesystem::path> truth = {};
};

// A part of the data, looked over.
struct PartData {
  std::string name;
  int pairs = 0;  // 0: it cannot be used, and the last remark says why
  double first_s = 0.0, last_s = 0.0, interval_s = 0.0;  // stamps; median from pair to pair
  std::vector<std::pair<int, double>> gaps;  // the pair before each, and how long it lasts, s
  int lone_images = 0, unreadable_images = 0;
  int inclinometer = 0, wheels = 0, inertial = 0, fixes = 0, rtk_fixed = 0;  // samples
  int surveyed_rocks = 0;
  std::string format, rig;
  bool antenna = false;  // whether the rig file states its position
  int width = 0, height = 0;
  double baseline_m = 0.0;
  std::vector<std::string> remarks;
};

struct TraversePlan {
  std::vector<PartData> parts;
  std::vector<PartJob> jobs;  // in order of time
};

// Reads all but the pixels. A part that cannot be used is named and makes no job. Throws as
// OpenDataset where none can be used or the request is wrong, and UsageError for a split that
// cannot be.
TraversePlan PlanTraverse(const PlanRequest& request);

// Pieces of a part of so many pairs, the fewest of which none has more than `max_pairs`, the
// `overlap` that neighbours share among them.
int PiecesOfAtMost(int max_pairs, int pairs, int overlap);
// The pairs of each piece, END excluded, in order: as equal as may be.
std::vector<std::pair<int, int>> CutEvenly(int pairs, int pieces, int overlap);

// Whether the part can be used.
inline bool IsUsable(const PartData& part) { return part.pairs > 0; }
int PairsOf(const TraversePlan& plan);  // of all jobs; those that two share count twice
// Seconds with `threads`, and megabytes, that a job will need: from what was measured
// (docs/measured.md).
double EstimatedSeconds(const PartJob& job, int threads);
double EstimatedJoinSeconds(const TraversePlan& plan, int threads);
double EstimatedMegabytes(const PartJob& job, int memory_mb);
// How many parts `rigmap run` does at the same time: as many as there are threads, for a part's
// stages do not keep several of them busy all the time, and as --memory allows.
int PartsAtOnce(const TraversePlan& plan, int threads, int memory_mb);
// What it will leave on the disk.
double EstimatedDiskMegabytes(const PartJob& job);
double EstimatedDiskMegabytes(const TraversePlan& plan);  // of all jobs and the whole

// {dataset, parts, jobs: [{name, arguments, pairs, threads, memory_mb, minutes, disk_mb}], total}.
// `arguments` are those of `rigmap part` that choose the data. Of a part that cannot be used there
// are only name, pairs and remarks.
nlohmann::ordered_json ToJson(const TraversePlan& plan, const PlanRequest& request);

// A script for sbatch: an array with a task for each job, which writes to OUT/parts/NAME.
std::string WriteSbatch(const TraversePlan& plan, const PlanRequest& request,
                        const std::vector<std::string>& part_arguments);

}  // namespace rigmap
