#include "pipeline/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/artefact.h"

namespace rigmap {

namespace fs = std::filesystem;

FrameFile FrameFileOf(const std::string& stage, std::int64_t stamp_ns, const std::string& key) {
  return {fmt::format("stages/{}/{}-{}.bin", stage, stamp_ns, key), key};
}

bool AreThere(const fs::path& root, const std::vector<FrameFile>& files) {
  return std::ranges::all_of(
      files, [&](const FrameFile& file) { return HasArtefact(file.In(root), file.key); });
}

void ForgetOlderFrames(const fs::path& root, const std::vector<FrameFile>& in_use) {
  if (in_use.empty()) return;
  std::set<fs::path> kept;
  for (const FrameFile& file : in_use) {
    kept.insert(file.In(root));
    std::error_code ignored;  // what cannot be touched is only forgotten earlier
    fs::last_write_time(file.In(root), fs::file_time_type::clock::now(), ignored);
  }
  // By frame: what the name begins with.
  std::map<std::string, std::vector<std::pair<fs::file_time_type, fs::path>>> others;
  for (const auto& entry : fs::directory_iterator(in_use.front().In(root).parent_path())) {
    if (kept.contains(entry.path())) continue;
    const std::string name = entry.path().filename().string();
    others[name.substr(0, name.find('-'))].emplace_back(entry.last_write_time(), entry.path());
  }
  for (auto& [frame, files] : others) {
    std::ranges::sort(files, std::greater());
    for (std::size_t i = 1; i < files.size(); ++i) fs::remove(files[i].second);
  }
}

}  // namespace rigmap
