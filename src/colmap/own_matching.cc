#include "colmap/own_matching.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <regex>

#include "colmap/internal/command_line.h"
#include "core/file.h"

namespace rigmap {
namespace {

// The number that `pattern` captures in a line of COLMAP's output.
std::optional<int> NumberIn(const std::string& line, const std::regex& pattern) {
  std::smatch match;
  if (!std::regex_search(line, match, pattern)) return std::nullopt;
  return std::stoi(match[1]);
}

void RunWithProgress(const ColmapInstallation& colmap, const CommandLine& command,
                     const OwnMatchingRequest& request, const std::regex& counted,
                     const std::string& purpose) {
  ProcessRequest process = ProcessOf(colmap, command, request.log, request.threads);
  process.on_line = [&](const std::string& line) {
    const auto done = NumberIn(line, counted);
    if (done && request.on_progress) request.on_progress(*done);
  };
  RunTool(process, purpose);
}

}  // namespace

void RunFeatureExtractor(const ColmapInstallation& colmap, const OwnMatchingRequest& request) {
  CommandLine command("feature_extractor");
  command.Path("database_path", request.database)
      .Path("image_path", request.images)
      .Number("random_seed", 0)
      .Number("SiftExtraction.use_gpu", 0)
      .Number("SiftExtraction.num_threads", request.threads);
  static const std::regex kProcessed("Processed file \\[([0-9]{1,9})/");
  RunWithProgress(colmap, command, request, kProcessed, "extracting features");
}

// COLMAP says nothing until a whole call's pairs are done, and one of images with 10 000 keypoints
// takes it seconds: so many that its silence is not taken for its end.
void RunMatchesImporter(const ColmapInstallation& colmap, const OwnMatchingRequest& request,
                        std::span<const std::pair<std::string, std::string>> pairs,
                        const std::filesystem::path& pair_list) {
  constexpr std::size_t kPairsPerCall = 20;
  std::filesystem::create_directories(pair_list.parent_path());
  for (std::size_t done = 0; done < pairs.size(); done += kPairsPerCall) {
    const auto batch = pairs.subspan(done, std::min(kPairsPerCall, pairs.size() - done));
    WriteFileAtomically(pair_list, [&](std::ostream& stream) {
      for (const auto& [a, b] : batch) stream << a << ' ' << b << '\n';
    });
    CommandLine command("matches_importer");
    command.Path("database_path", request.database)
        .Path("match_list_path", pair_list)
        .Text("match_type", "pairs")
        .Number("random_seed", 0)
        .Number("SiftMatching.use_gpu", 0)
        .Number("SiftMatching.num_threads", request.threads);
    RunTool(ProcessOf(colmap, command, request.log, request.threads), "matching features");
    if (request.on_progress) request.on_progress(static_cast<int>(done + batch.size()));
  }
}

}  // namespace rigmap
