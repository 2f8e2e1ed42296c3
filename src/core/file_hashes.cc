#include "core/file_hashes.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cereal/types/map.hpp>

#include "core/artefact.h"
#include "core/error.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr const char* kKey = "file hashes, inodes";

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
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
    throw DataError(fmt::format("{}: expected a file, found none", path.string()));
  }
  Entry entry;
  entry.bytes = static_cast<std::uintmax_t>(status.st_size);
  entry.modified_ns = 1'000'000'000LL * status.st_mtim.tv_sec + status.st_mtim.tv_nsec;
  entry.inode = status.st_ino;
  const std::string name = NameOf(path);
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(name);
    if (known != known_.end() && known->second.IsSameFile(entry)) {
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
