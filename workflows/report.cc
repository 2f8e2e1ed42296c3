#include "workflows/report.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/error.h"
#include "core/json_file.h"
#include "report/result_folder.h"
#include "report/write_report.h"
#include "workflows/output_folder.h"
#include "workflows/part_options.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Each option of config.yaml that is not as it would be without any, a line each.
std::vector<std::string> ChangedOptions(const fs::path& config) {
  std::vector<std::string> changed;
  if (!fs::exists(config)) return changed;
  PartOptions used, defaults;
  try {
    used = LoadPartOptions(config, {});
  } catch (const Error& error) {
    return {fmt::format("of another release: {}", error.what())};
  }
  const auto sections = used.Sections(), as_default = defaults.Sections();
  for (std::size_t s = 0; s < sections.size(); ++s) {
    for (std::size_t f = 0; f < sections[s].fields.size(); ++f) {
      const std::string value = OptionValueText(sections[s].fields[f]);
      const std::string usual = OptionValueText(as_default[s].fields[f]);
      if (value == usual) continue;
      changed.push_back(fmt::format("{}.{}={} (default {})", sections[s].name,
                                    sections[s].fields[f].name, value, usual));
    }
  }
  return changed;
}

ReportRequest RequestOf(const fs::path& folder) {
  return {.folder = folder, .changed_options = ChangedOptions(folder / "config.yaml")};
}

}  // namespace

std::string WriteReports(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) RequireResult(folder);
  std::string lines;
  for (const fs::path& folder : folders) {
    const OutputLock lock(folder);
    TakeFromJson(folder, "results as rigmap writes them", [&] { WriteReport(RequestOf(folder)); });
    lines += fmt::format("{}\n", (folder / "report.html").string());
  }
  return lines;
}

void TryToWriteReport(const fs::path& folder, const Dataset* dataset) {
  try {
    ReportRequest request = RequestOf(folder);
    if (dataset) {
      for (const StereoFrame& frame : dataset->frames) {
        request.images.emplace(frame.stamp_ns, frame.left_path);
      }
    }
    WriteReport(request);
  } catch (const std::exception& error) {
    spdlog::warn("no report was written: {}", error.what());
  }
}

}  // namespace rigmap
