#include "pipeline/internal/stage_files.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScratch = "scratch-";  // and the name of the stage

}  // namespace

fs::path StageFiles::Product(const std::string& stage, const std::string& key) const {
  return root_ / "stages" / fmt::format("{}-{}.bin", stage, key);
}

fs::path StageFiles::Log(const std::string& stage) const {
  return root_ / "logs" / (stage + ".log");
}

fs::path StageFiles::Scratch(const std::string& stage) const {
  return root_ / "stages" / (kScratch + stage);
}

void StageFiles::RemoveScratch() const {
  std::error_code missing;
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(root_ / "stages", missing)) {
    if (entry.path().filename().string().starts_with(kScratch)) left.push_back(entry.path());
  }
  for (const fs::path& path : left) fs::remove_all(path);
}

void StageFiles::Discard(const StageNode& stage) const {
  std::vector<fs::path> paths{Scratch(stage.name)};
  for (const std::string& name : stage.publishes) paths.push_back(root_ / name);
  for (const fs::path& path : paths) {
    std::error_code code;
    fs::remove_all(path, code);
    if (code) spdlog::warn("what is left of {} cannot be removed: {}", stage.name, code.message());
  }
}

void StageFiles::ForgetOlderProducts(const std::string& stage, const std::string& key) const {
  constexpr std::size_t kOthers = 1;
  const fs::path newest = Product(stage, key);
  std::vector<std::pair<fs::file_time_type, fs::path>> others;
  for (const auto& entry : fs::directory_iterator(root_ / "stages")) {
    const std::string name = entry.path().filename().string();
    if (entry.path() != newest && name.starts_with(stage + "-")) {
      others.emplace_back(entry.last_write_time(), entry.path());
    }
  }
  std::ranges::sort(others, std::greater());
  for (std::size_t i = kOthers; i < others.size(); ++i) fs::remove(others[i].second);
}

}  // namespace rigmap
