#include "core/file_hashes.h"

#include <fmt/format.h>

#include <cereal/types/map.hpp>

#include "core/artefact.h"
#include "core/error.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr const char* kKey = "file hashes";

std::string NameOf(const fs::path& path) {
  return (path.parent_path().filename() / path.filename()).string();
}

}  // namespace

FileHashes::FileHashes(const fs::path& remembered) {
  if (auto known = ReadArtefact<std::map<std::string, Entry>>(remembered, kKey)) {
    known_ = std::move(*known);
  }
}

std::string FileHashes::Hash(const fs::path& path) {
  std::error_code size_code, time_code;
  Entry entry;
  entry.bytes = fs::file_size(path, size_code);
  entry.modified_ns = fs::last_write_time(path, time_code).time_since_epoch().count();
  if (size_code || time_code) {
    throw DataError(fmt::format("{}: expected a file, found none", path.string()));
  }
  const std::string name = NameOf(path);
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(name);
    if (known != known_.end() && known->second.bytes == entry.bytes &&
        known->second.modified_ns == entry.modified_ns) {
      asked_[name] = known->second;
      return known->second.hash;
    }
  }
  entry.hash = HashFile(path);
  const std::lock_guard lock(mutex_);
  asked_[name] = entry;
  return entry.hash;
}

void FileHashes::Save(const fs::path& path) const {
  const std::lock_guard lock(mutex_);
  WriteArtefact(path, kKey, asked_);
}

}  // namespace rigmap
