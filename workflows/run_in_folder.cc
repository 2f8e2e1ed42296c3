#include "workflows/run_in_folder.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "colmap/database.h"
#include "core/file.h"
#include "pipeline/stage_runner.h"
#include "workflows/mark_outputs.h"
#include "workflows/output_folder.h"
#include "workflows/part_summary.h"
#include "workflows/recipes.h"
#include "workflows/report.h"
#include "workflows/rig_prior.h"
#include "workflows/stages/database.h"
#include "workflows/stages/features.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

void WriteOutcome(const fs::path& root, const FolderRun& run, Ledger ledger,
                  const std::string& failure) {
  MarkOutputs(root, ledger);
  if (!ledger.stages.empty()) {
    RecordSizes(root, ledger);
    WriteLedger(ledger, root);
  }
  WriteFileAtomically(root / "summary.json", [&](std::ostream& stream) {
    stream << WriteSummary(ledger, run.name, run.request, failure);
  });
  WriteFileAtomically(root / "config.yaml", [&](std::ostream& stream) {
    stream << WritePartOptions(run.request.options);
  });
}

// The reason of a failure matters more than a summary that cannot be written.
void TryToWriteFailure(const fs::path& root, const FolderRun& run, const std::string& failure) {
  try {
    WriteOutcome(root, run, ReadLedger(root), failure);
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
  PooledRig rig_file;
  FileHashes hashes;  // of its files
  DatasetContent content;

  KnownInput(Dataset opened, const fs::path& remembered)
      : dataset(std::move(opened)),
        rig_file{dataset.rig, dataset.rig_pool},
        hashes(remembered),
        content(HashContent(dataset, hashes)) {
    const auto prior = WithoutPart(rig_file, content.images);
    if (!prior) return;
    dataset.rig = prior->rig;
    content.rig = HashRig(dataset, hashes);
    spdlog::info("{}", prior->remark);
    dataset.health.remarks.push_back(prior->remark);
  }
};

Ledger RunRecipe(const FolderRun& run, const fs::path& root, const KnownInput& input, Job& job) {
  const PartRequest& request = run.request;
  const StageGraph recipe = run.recipe(input.dataset, input.content);
  StageRunner runner(recipe, root,
                     {run.name, request.until, request.from, request.memory_mb, KnownOutputs(),
                      request.take_up_frames});
  NameWhatGoes(runner);
  input.hashes.Save(HashesPath(root));
  RenewLinks(root, input.dataset);
  runner.Run(job);
  return runner.ledger();
}

}  // namespace

fs::path HashesPath(const fs::path& root) { return root / "stages" / "hashes.bin"; }

PartResult RunInFolder(const FolderRun& run, Dataset dataset, Job& job) {
  const PartRequest& request = run.request;
  const fs::path root = fs::absolute(request.out);
  RequireInputElsewhere(root, dataset);
  const KnownInput input(std::move(dataset), HashesPath(root));
  const FolderMark mark = run.mark.value_or(MarkOf(input.dataset, input.content));
  RequireOwnOutput(root, mark, request.force);
  const OutputLock lock(root);
  RequireUnlocked(ColmapFolder{root}.Database());
  RequireOwnOutput(root, mark, request.force);
  ClaimOutput(root, mark, request.force);
  try {
    WriteJoinableInput(root, {input.dataset, input.content, input.rig_file});
    const Ledger ledger = RunRecipe(run, root, input, job);
    WriteOutcome(root, run, ledger, "");
    TryToWriteReport(root, &input.dataset);
    return Judge(ledger, FirstFrame(request));
  } catch (const std::exception& error) {
    job.LogToTerminal();
    TryToWriteFailure(root, run, error.what());
    TryToWriteReport(root, &input.dataset);
    throw;
  }
}

}  // namespace rigmap
