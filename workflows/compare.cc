#include "workflows/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/artefact.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "workflows/comparison.h"
#include "workflows/output_folder.h"
#include "workflows/reconstruct_part.h"
#include "workflows/report.h"
#include "workflows/run_in_folder.h"
#include "workflows/truth_files.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

struct Run {
  RunName name;
  PartRequest request;

  const fs::path& Out() const { return request.out; }
  // The row, kept beside the folder.
  fs::path RowFile() const { return Out().string() + ".json"; }
};

// COLMAP samples at random; all else gives equal results for equal data.
bool HasChance(Technique technique) {
  return technique == Technique::kRig || technique == Technique::kColmap ||
         technique == Technique::kSfm || technique == Technique::kCombined;
}

std::string NameOfData(const DatasetRequest& dataset) {
  fs::path folder = fs::absolute(dataset.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  std::string name = folder.filename().string();
  // What the simulator writes is called so everywhere.
  if (name == "data") name = folder.parent_path().filename().string() + "-data";
  if (dataset.traverse) name += fmt::format("-traverse{}", *dataset.traverse);
  if (dataset.part) name += fmt::format("-part{}", *dataset.part);
  if (dataset.frames) {
    name += fmt::format("-frames{}-{}", dataset.frames->first, dataset.frames->second);
  }
  return name;
}

// What else lies there is not ours.
std::vector<fs::path> FoldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  if (!fs::is_directory(folder)) return folders;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  return folders;
}

// The mark of any result of the part, and the folder that bears it.
std::optional<std::pair<FolderMark, fs::path>> AnyResult(const fs::path& part) {
  for (const fs::path& label : FoldersIn(part)) {
    for (const fs::path& folder : FoldersIn(label)) {
      if (auto mark = MarkIn(folder)) return std::pair(std::move(*mark), folder);
    }
  }
  return std::nullopt;
}

// What tells the frames from any others; of data that cannot be opened their path.
std::string KeyOf(const DatasetRequest& request, const fs::path& hashes) {
  try {
    const Dataset dataset = OpenDataset(request);
    FileHashes known(hashes);
    return HashContent(dataset, known).FramesKey();
  } catch (const DataError&) {
    return HashText(fs::absolute(request.folder).string());
  }
}

// The part's name or, where results of other data bear it, with a few digits that tell them apart.
std::string NameAmong(const fs::path& runs, const PartRequest& part) {
  const std::string name = NameOfData(part.dataset);
  const auto found = AnyResult(runs / name);
  if (!found) return name;
  Job job(part.threads, true);
  const std::string key = job.Run([&] { return KeyOf(part.dataset, HashesPath(found->second)); });
  constexpr int kDigits = 8;
  return key == found->first.frames ? name : name + "-" + key.substr(0, kDigits);
}

// Every combination of the sweeps' values, as assignments; one without any if there is no sweep.
std::vector<std::vector<std::string>> Settings(const std::vector<Sweep>& sweeps) {
  std::vector<std::vector<std::string>> settings{{}};
  for (const Sweep& sweep : sweeps) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& setting : settings) {
      for (const std::string& value : sweep.values) {
        longer.push_back(setting);
        longer.back().push_back(sweep.option + "=" + value);
      }
    }
    settings = std::move(longer);
  }
  return settings;
}

bool Names(const std::vector<std::string>& setting, const std::string& option) {
  return std::ranges::any_of(
      setting, [&](const std::string& assignment) { return assignment.starts_with(option + "="); });
}

// The true trajectory beside which the part is judged; empty where there is none.
std::string TruthOf(const PartRequest& part) {
  if (part.truth) return fs::absolute(TruthOfRun(*part.truth, part.dataset)).string();
  Job job(part.threads, true);
  try {
    return job.Run([&] { return OpenDataset(part.dataset).truth_path; });
  } catch (const DataError&) {
    return "";  // its rows say why
  }
}

// By each technique, with each setting, as often as chance has a say.
std::vector<Run> PlanRuns(const CompareRequest& request, const PartRequest& part) {
  const std::string part_name = NameAmong(request.out / "runs", part), truth = TruthOf(part);
  std::vector<Run> runs;
  for (const Technique technique : request.techniques) {
    for (const auto& setting : Settings(request.sweeps)) {
      const int repeats = HasChance(technique) ? request.repeats : 1;
      for (int repeat = 0; repeat < repeats; ++repeat) {
        const std::string technique_name(NameOf(technique));
        Run run{{part_name, technique_name, fmt::format("{}", fmt::join(setting, " ")), repeat},
                part};
        std::vector<std::string> assignments = request.assignments;
        for (const char* seed : {"mapping.random_seed", "sfm.random_seed"}) {
          if (repeat > 0) assignments.push_back(fmt::format("{}={}", seed, repeat));
        }
        assignments.insert(assignments.end(), setting.begin(), setting.end());
        run.request.technique = technique;
        run.request.take_up_frames = false;  // a stage that is made takes the time that it takes
        run.request.options = LoadPartOptions(request.config, assignments);
        if (!Names(setting, "gates.accuracy_pct")) {
          run.request.options.gates.poses.accuracy_pct = part.options.gates.poses.accuracy_pct;
        }
        const std::string label = setting.empty()
                                      ? technique_name
                                      : fmt::format("{} {}", technique_name, run.name.setting);
        run.name.run = fs::path("runs") / part_name / label / std::to_string(repeat);
        run.name.truth = truth;
        run.request.out = request.out / run.name.run;
        runs.push_back(std::move(run));
      }
    }
  }
  return runs;
}

// Of all parts that the request names.
std::vector<Run> PlanRuns(const CompareRequest& request) {
  const std::vector<DatasetRequest> parts = PartsOf(request.part->dataset);
  if (parts.size() == 1) return PlanRuns(request, *request.part);
  std::vector<Run> runs;
  for (const DatasetRequest& dataset : parts) {
    PartRequest part = *request.part;
    part.dataset = dataset;
    part.truth = TruthOfPart(request.part->truth, dataset);
    std::ranges::move(PlanRuns(request, part), std::back_inserter(runs));
  }
  return runs;
}

bool IsResult(const fs::path& folder) { return fs::exists(folder / ".dataset"); }

// A result of the same part to begin from: one by the same technique, else any.
std::optional<fs::path> FindDonor(const Run& run) {
  std::optional<fs::path> donor;
  const fs::path part = run.Out().parent_path().parent_path();
  for (const fs::path& label : FoldersIn(part)) {
    for (const fs::path& folder : FoldersIn(label)) {
      if (!IsResult(folder)) continue;
      const bool alike = label.filename().string().starts_with(run.name.technique);
      if (!donor || alike) donor = folder;
      if (alike) return donor;
    }
  }
  return donor;
}

// What another run of the part has found need not be found again: a new run begins with its stages,
// and takes up those that hold for it, with the time that they took when they were made.
void BeginWithStagesOf(const fs::path& donor, const fs::path& out) {
  const fs::path whole = out.string() + ".new";
  fs::remove_all(whole);
  fs::create_directories(whole);
  constexpr auto kCopy = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
  for (const char* name : {".dataset", "stages", "colmap"}) {
    if (fs::exists(donor / name)) fs::copy(donor / name, whole / name, kCopy);
  }
  fs::rename(whole, out);
}

ComparisonRow Do(const Run& run) {
  try {
    ReconstructPart(run.request);
    return MakeRow(run.name, run.Out());
  } catch (const UsageError& error) {
    return MakeFailedRow(run.name, 2, error.what());
  } catch (const std::exception& error) {
    return MakeFailedRow(run.name, 1, error.what());
  }
}

void DoAll(const CompareRequest& request) {
  const std::vector<Run> runs = PlanRuns(request);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i];
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
  std::ranges::sort(rows, {}, [](const ComparisonRow& row) {
    return std::tuple(row["part"].get<std::string>(), OrderOf(row["technique"]),
                      row["setting"].get<std::string>(), row["repeat"].get<int>());
  });
  return rows;
}

std::vector<ComparisonRow> RowsOf(const std::vector<fs::path>& outs) {
  std::vector<ComparisonRow> rows;
  for (const fs::path& out : outs) {
    ComparisonRow row =
        MakeRow({.part = out.lexically_normal().string(), .run = fs::absolute(out)}, out);
    const auto summary = nlohmann::json::parse(ReadTextFile(out / "summary.json"));
    row["technique"] = summary.value("technique", "rig");
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Sweep ParseSweep(const std::string& text) {
  const std::size_t equals = text.find('=');
  Sweep sweep{text.substr(0, equals), {}};
  std::string rest = equals == std::string::npos ? "" : text.substr(equals + 1);
  for (std::size_t comma = 0; comma != std::string::npos && !rest.empty();) {
    comma = rest.find(',');
    sweep.values.push_back(rest.substr(0, comma));
    rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
  }
  if (sweep.option.find('.') == std::string::npos || sweep.values.empty() ||
      std::ranges::any_of(sweep.values, &std::string::empty)) {
    throw UsageError(fmt::format("--sweep: expected stage.option=a,b,c, found '{}'", text));
  }
  return sweep;
}

std::string Compare(const CompareRequest& request) {
  RequireComparisonOutput(request.out);
  if (request.part) DoAll(request);
  const auto rows = request.part ? StoredRows(request.out) : RowsOf(request.outs);
  const auto comparison = WriteComparison(rows);
  fs::create_directories(request.out);
  WriteFileAtomically(request.out / "comparison.json",
                      [&](std::ostream& stream) { stream << comparison.dump(1) << "\n"; });
  WriteFileAtomically(request.out / "comparison.csv",
                      [&](std::ostream& stream) { stream << WriteComparisonCsv(rows); });
  TryToWriteReport(request.out, nullptr);
  return FormatComparison(comparison);
}

}  // namespace rigmap
