#include "workflows/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/file.h"
#include "workflows/comparison.h"
#include "workflows/comparison_runs.h"
#include "workflows/output_folder.h"
#include "workflows/part_folder.h"
#include "workflows/reconstruct_part.h"
#include "workflows/report.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// A result of the same part to begin from: one by the same technique, else any.
std::optional<fs::path> FindDonor(const ComparisonRun& run) {
  std::optional<fs::path> donor;
  const fs::path part = run.Out().parent_path().parent_path();
  for (const fs::path& label : FoldersIn(part)) {
    for (const fs::path& folder : FoldersIn(label)) {
      if (!MarkIn(folder)) continue;
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
  const fs::path whole = out.string() + ".new";
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
                        [&](std::ostream& stream) { stream << row.dump(1) << "\n"; });
  }
}

// Where a technique stands among all; those of other releases last.
std::size_t OrderOf(const std::string& technique) {
  constexpr auto kNames = NamesOf(Technique{});
  return static_cast<std::size_t>(std::ranges::find(kNames, technique) - kNames.begin());
}

void SortRows(std::vector<ComparisonRow>& rows) {
  std::ranges::sort(rows, {}, [](const ComparisonRow& row) {
    return std::tuple(row["part"].get<std::string>(), OrderOf(row["technique"]),
                      row["setting"].get<std::string>(), row["repeat"].get<int>());
  });
}

bool IsRow(const ComparisonRow& row) {
  return row.is_object() && row.contains("part") && row.contains("technique") &&
         row.contains("setting") && row.contains("repeat") && row.contains("status");
}

// Of every run below out/runs, whichever call of compare has made it.
std::vector<ComparisonRow> StoredRows(const fs::path& out) {
  std::vector<ComparisonRow> rows;
  for (const fs::path& part : FoldersIn(out / "runs")) {
    for (const fs::path& label : FoldersIn(part)) {
      for (const auto& entry : fs::directory_iterator(label)) {
        if (entry.path().extension() != ".json") continue;
        auto row = ComparisonRow::parse(ReadTextFile(entry.path()), nullptr, false);
        if (IsRow(row)) {
          rows.push_back(std::move(row));
        } else {
          spdlog::warn("{}: expected the row of a run, found something else; left out",
                       entry.path().string());
        }
      }
    }
  }
  SortRows(rows);
  return rows;
}

// How its options differ from the defaults; nothing where another release wrote them.
std::string SettingOfResult(const fs::path& out) {
  try {
    const PartOptions options = LoadPartOptions(out / "config.yaml", {});
    return fmt::format("{}", fmt::join(ListChangedOptions(options), " "));
  } catch (const std::exception& error) {
    spdlog::warn("{}; its setting is not told", error.what());
    return "";
  }
}

// Names for the data of results, by their marks: equal for equal frames alone.
std::vector<std::string> NamesOfData(const std::vector<PartFolder>& results) {
  std::map<std::string, std::string> names;  // by the frames
  std::set<std::string> taken;
  std::vector<std::string> of_results;
  for (const PartFolder& result : results) {
    const FolderMark mark = MarkIn(result.root).value_or(FolderMark{result.name, result.name});
    auto& name = names[mark.frames];
    if (name.empty()) {
      name = mark.description;
      for (int i = 2; !taken.insert(name).second; ++i) {
        name = fmt::format("{} ({})", mark.description, i);
      }
    }
    of_results.push_back(name);
  }
  return of_results;
}

// Results that lie anywhere. What is alike but for its folder bears the folder's name, too.
std::vector<ComparisonRow> RowsOf(const std::vector<fs::path>& outs) {
  const std::vector<PartFolder> results = NameParts(outs);
  const std::vector<std::string> data = NamesOfData(results);
  std::vector<ComparisonRow> rows;
  std::map<std::string, int> alike;
  const auto key = [](const ComparisonRow& row) {
    return row["part"].dump() + row["technique"].dump() + row["setting"].dump();
  };
  for (std::size_t i = 0; i < results.size(); ++i) {
    ComparisonRow row = MakeRow({.part = data[i], .run = results[i].root}, results[i].root);
    const auto summary = nlohmann::json::parse(ReadTextFile(results[i].root / "summary.json"));
    row["technique"] = summary.value("technique", "rig");
    row["setting"] = SettingOfResult(results[i].root);
    ++alike[key(row)];
    rows.push_back(std::move(row));
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (alike[key(rows[i])] == 1) continue;
    const std::string setting = rows[i]["setting"];
    rows[i]["setting"] =
        fmt::format("{}{}in {}", setting, setting.empty() ? "" : " ", results[i].name);
  }
  SortRows(rows);
  return rows;
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
                      [&](std::ostream& stream) { stream << comparison.dump(1) << "\n"; });
  WriteFileAtomically(request.out / "comparison.csv",
                      [&](std::ostream& stream) { stream << WriteComparisonCsv(rows); });
  TryToWriteReport(request.out, nullptr);
  for (const std::string& remark : SettingsWithoutEffect(rows)) spdlog::warn("{}", remark);
  return FormatComparison(comparison);
}

}  // namespace rigmap
