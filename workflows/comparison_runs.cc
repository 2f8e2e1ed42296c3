#include "workflows/comparison_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/artefact.h"
#include "core/error.h"
#include "core/job.h"
#include "workflows/output_folder.h"
#include "workflows/run_in_folder.h"
#include "workflows/truth_files.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr int kDigits = 8;  // of a hash that tells names apart

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

std::vector<std::string> SweptOptions(const std::vector<Sweep>& sweeps) {
  std::vector<std::string> swept;
  for (const Sweep& sweep : sweeps) swept.push_back(sweep.option);
  return swept;
}

// How a run differs from one with all defaults, whichever of --set, --config, --accuracy, --rig
// and --sweep says so; swept options in any case.
std::string SettingOf(const PartRequest& run, const std::vector<std::string>& swept) {
  std::vector<std::string> setting = ListChangedOptions(run.options, swept);
  if (run.dataset.rig) {
    setting.push_back(fmt::format("rig={}-{}", run.dataset.rig->stem().string(),
                                  HashFile(*run.dataset.rig).substr(0, kDigits)));
  }
  return fmt::format("{}", fmt::join(setting, " "));
}

// Of the folder of a technique with a setting: long ones are cut, as file systems take 255 bytes.
std::string LabelOf(const std::string& technique, const std::string& setting) {
  if (setting.empty()) return technique;
  std::string label = technique + " " + setting;
  constexpr std::size_t kLongest = 120;
  if (label.size() > kLongest) {
    label = label.substr(0, kLongest) + "-" + HashText(label).substr(0, kDigits);
  }
  std::ranges::replace(label, '/', '_');
  return label;
}

// The options of a run: those of the configuration and those that it sweeps.
PartOptions OptionsOf(const CompareRequest& request, const std::vector<std::string>& swept) {
  std::vector<std::string> assignments = request.assignments;
  assignments.insert(assignments.end(), swept.begin(), swept.end());
  return LoadPartOptions(request.config, assignments);
}

bool Sweeps(const CompareRequest& request, const std::string& option) {
  return std::ranges::find(request.sweeps, option, &Sweep::option) != request.sweeps.end();
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

// Of a repeat: those that the options name belong to the first run.
void TakeNextSeeds(PartOptions& options) {
  ++options.mapping.random_seed;
  ++options.free_mapping.random_seed;
}

// By each technique, with each setting, as often as chance has a say.
std::vector<ComparisonRun> PlanRuns(const CompareRequest& request, const PartRequest& part) {
  const std::string part_name = NameAmong(request.out / "runs", part), truth = TruthOf(part);
  std::vector<ComparisonRun> runs;
  for (const Technique technique : request.techniques) {
    for (const auto& swept : Settings(request.sweeps)) {
      ComparisonRun run{{.part = part_name, .technique = std::string(NameOf(technique))}, part};
      run.request.technique = technique;
      run.request.take_up_frames = false;  // a stage that is made takes the time that it takes
      run.request.options = OptionsOf(request, swept);
      if (!Sweeps(request, "gates.accuracy_pct")) {
        run.request.options.gates.poses.accuracy_pct = part.options.gates.poses.accuracy_pct;
      }
      run.name.setting = SettingOf(run.request, SweptOptions(request.sweeps));
      run.name.truth = truth;
      const std::string label = LabelOf(run.name.technique, run.name.setting);
      const int repeats = HasChance(technique) ? request.repeats : 1;
      for (int repeat = 0; repeat < repeats; ++repeat) {
        run.name.repeat = repeat;
        if (repeat > 0) TakeNextSeeds(run.request.options);
        run.name.run = fs::path("runs") / part_name / label / std::to_string(repeat);
        run.request.out = request.out / run.name.run;
        runs.push_back(run);
      }
    }
  }
  return runs;
}

}  // namespace

std::vector<ComparisonRun> PlanComparison(const CompareRequest& request) {
  const std::vector<DatasetRequest> parts = PartsOf(request.part->dataset);
  if (parts.size() == 1) return PlanRuns(request, *request.part);
  std::vector<ComparisonRun> runs;
  for (const DatasetRequest& dataset : parts) {
    PartRequest part = *request.part;
    part.dataset = dataset;
    part.truth = TruthOfPart(request.part->truth, dataset);
    std::ranges::move(PlanRuns(request, part), std::back_inserter(runs));
  }
  return runs;
}

std::vector<fs::path> FoldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  if (!fs::is_directory(folder)) return folders;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory()) folders.push_back(entry.path());
  }
  return folders;
}

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

}  // namespace rigmap
