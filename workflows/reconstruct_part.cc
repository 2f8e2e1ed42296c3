#include "workflows/reconstruct_part.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "colmap/database.h"
#include "core/file.h"
#include "dataset/open_dataset.h"
#include "export/tum.h"
#include "pipeline/stage_runner.h"
#include "workflows/evaluate_part.h"
#include "workflows/mark_outputs.h"
#include "workflows/output_folder.h"
#include "workflows/part_summary.h"
#include "workflows/report.h"
#include "workflows/rig_prior.h"
#include "workflows/stages/database.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

fs::path HashesPath(const fs::path& root) { return root / "stages" / "hashes.bin"; }

// The dataset with the truth that it is to be compared with: a TUM file that can be read. Known to
// be wrong now, not when all work is done.
Dataset OpenWithTruth(const PartRequest& request) {
  Dataset dataset = OpenDataset(request.dataset);
  if (request.truth) dataset.truth_path = fs::absolute(TruthFile(*request.truth)).string();
  if (!dataset.truth_path.empty()) ReadTum(dataset.truth_path);
  return dataset;
}

void WriteOutcome(const fs::path& root, const PartRequest& request, const Ledger& ledger,
                  const std::string& failure) {
  MarkOutputs(root, ledger);
  WriteFileAtomically(root / "summary.json", [&](std::ostream& stream) {
    stream << WriteSummary(ledger, request, failure);
  });
  WriteFileAtomically(root / "config.yaml",
                      [&](std::ostream& stream) { stream << WritePartOptions(request.options); });
}

// The reason of a failure matters more than a summary that cannot be written.
void TryToWriteFailure(const fs::path& root, const PartRequest& request,
                       const std::string& failure) {
  try {
    WriteOutcome(root, request, ReadLedger(root), failure);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
}

// What of an earlier result is about to go.
void NameWhatGoes(const StageRunner& runner) {
  if (runner.outdated_outputs().empty()) return;
  spdlog::warn("made from other inputs, options or code, and removed: {}",
               fmt::join(runner.outdated_outputs(), ", "));
}

// The images may have moved since they were linked.
void RenewLinks(const fs::path& root, const Dataset& dataset) {
  const ColmapFolder colmap{root};
  if (fs::exists(colmap.Images())) LinkImages(dataset, colmap.Images());
}

// What a run has found out about its input before it begins.
struct KnownInput {
  Dataset dataset;
  FileHashes hashes;  // of its files
  DatasetContent content;

  KnownInput(Dataset opened, const fs::path& remembered)
      : dataset(std::move(opened)), hashes(remembered), content(HashContent(dataset, hashes)) {
    const auto prior = WithoutPart({dataset.rig, dataset.rig_pool}, content.images);
    if (!prior) return;
    dataset.rig = prior->rig;
    content.rig = HashRig(dataset, hashes);
    spdlog::info("{}", prior->remark);
    dataset.health.remarks.push_back(prior->remark);
  }
};

Ledger RunRecipe(const PartRequest& request, const fs::path& root, const KnownInput& input,
                 Job& job) {
  const StageGraph recipe =
      MakeRecipe(request.technique, input.dataset, input.content, request.options);
  StageRunner runner(
      recipe, root,
      {NameOf(request.technique), request.until, request.from, request.memory_mb, KnownOutputs()});
  NameWhatGoes(runner);
  input.hashes.Save(HashesPath(root));
  RenewLinks(root, input.dataset);
  runner.Run(job);
  return runner.ledger();
}

PartResult Reconstruct(const PartRequest& request, Job& job) {
  const fs::path root = fs::absolute(request.out);
  Dataset dataset = OpenWithTruth(request);
  RequireInputElsewhere(root, dataset);
  const KnownInput input(std::move(dataset), HashesPath(root));
  const FolderMark mark = MarkOf(input.dataset, input.content);
  RequireOwnOutput(root, mark, request.force);
  const OutputLock lock(root);
  RequireUnlocked(ColmapFolder{root}.Database());
  RequireOwnOutput(root, mark, request.force);
  ClaimOutput(root, mark, request.force);
  try {
    const Ledger ledger = RunRecipe(request, root, input, job);
    WriteOutcome(root, request, ledger, "");
    TryToWriteReport(root, &input.dataset);
    return Judge(ledger, FirstFrame(request));
  } catch (const std::exception& error) {
    job.LogToTerminal();
    TryToWriteFailure(root, request, error.what());
    TryToWriteReport(root, &input.dataset);
    throw;
  }
}

}  // namespace

PartResult ReconstructPart(const PartRequest& request) {
  cv::setNumThreads(1);  // of every part in this process: the work is split over frames
  Job job(request.threads, request.quiet);
  return job.Run([&] { return Reconstruct(request, job); });
}

}  // namespace rigmap
