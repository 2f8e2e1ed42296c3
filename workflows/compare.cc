#include "workflows/compare.h"

#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/json_text.h"
#include "workflows/compared_rows.h"
#include "workflows/comparison.h"
#include "workflows/comparison_runs.h"
#include "workflows/output_folder.h"
#include "workflows/reconstruct_part.h"
#include "workflows/report.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".new";  // what is not whole yet ends with

// A result of the same part to begin from: one by the same technique, else any.
std::optional<fs::path> FindDonor(const ComparisonRun& run) {
  std::optional<fs::path> donor;
  const fs::path part = run.Out().parent_path().parent_path();
  for (const fs::path& label : FoldersIn(part)) {
    for (const fs::path& folder : FoldersIn(label)) {
      if (!MarkIn(folder) || folder.extension() == kUnfinished) continue;
      const bool alike = label.filename().string().starts_with(run.name.technique);
      if (!donor || alike) donor = folder;
      if (alike) return donor;
    }
  }
  return donor;
}

// Files of stages are replaced whole and never changed, so that results can share them.
void ShareStages(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::copy(from, to, fs::copy_options::recursive | fs::copy_options::create_hard_links, code);
  if (!code) return;
  fs::remove_all(to);  // where the file system cannot
  fs::copy(from, to, fs::copy_options::recursive);
}

// What another run of the part has found need not be found again: a new run begins with its stages,
// and takes up those that hold for it, with the time that they took when they were made.
void BeginWithStagesOf(const fs::path& donor, const fs::path& out) {
  const fs::path whole = out.string() + kUnfinished;
  fs::remove_all(whole);
  fs::create_directories(whole);
  constexpr auto kCopy = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
  for (const char* name : {".dataset", "colmap"}) {
    if (fs::exists(donor / name)) fs::copy(donor / name, whole / name, kCopy);
  }
  if (fs::exists(donor / "stages")) ShareStages(donor / "stages", whole / "stages");
  fs::rename(whole, out);
}

ComparisonRow Do(const ComparisonRun& run) {
  try {
    ReconstructPart(run.request);
    return MakeRow(run.name, run.Out());
  } catch (const UsageError& error) {
    return MakeFailedRow(run.name, 2, error.what());
  } catch (const std::exception& error) {
    return MakeFailedRow(run.name, 1, error.what());
  }
}

void DoAll(const CompareRequest& request, const std::vector<ComparisonRun>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ComparisonRun& run = runs[i];
    if (!request.part->quiet) {
      spdlog::info("run {} of {}: {}", i + 1, runs.size(), run.Out().string());
    }
    fs::create_directories(run.Out().parent_path());
    if (!fs::exists(run.Out())) {
      if (const auto donor = FindDonor(run)) BeginWithStagesOf(*donor, run.Out());
    }
    const ComparisonRow row = Do(run);
    if (row["status"] != "ok") {
      spdlog::warn("{} {}: {}", run.name.technique, row["status"].get<std::string>(),
                   row["reason"].is_string() ? row["reason"].get<std::string>() : "");
    }
    WriteFileAtomically(run.RowFile(),
                        [&](std::ostream& stream) { stream << JsonText(row, 1) << "\n"; });
  }
}

}  // namespace

std::string Compare(const CompareRequest& request) {
  RequireComparisonOutput(request.out);
  const auto runs = request.part ? PlanComparison(request) : std::vector<ComparisonRun>();
  const auto results = request.part ? std::vector<ComparisonRow>() : RowsOf(request.outs);
  const OutputLock lock(request.out);
  DoAll(request, runs);
  const auto rows = request.part ? StoredRows(request.out) : results;
  const auto comparison = WriteComparison(rows);
  WriteFileAtomically(request.out / "comparison.json",
                      [&](std::ostream& stream) { stream << JsonText(comparison, 1) << "\n"; });
  WriteFileAtomically(request.out / "comparison.csv",
                      [&](std::ostream& stream) { stream << WriteComparisonCsv(rows); });
  TryToWriteReport(request.out, nullptr);
  for (const std::string& remark : SettingsWithoutEffect(rows)) spdlog::warn("{}", remark);
  return FormatComparison(comparison);
}

}  // namespace rigmap
