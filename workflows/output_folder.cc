#include "workflows/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr const char* kLockName = ".lock";
constexpr const char* kIdentityName = "stages/dataset.txt";

bool IsEmpty(const fs::path& root) {
  return std::all_of(fs::directory_iterator(root), fs::directory_iterator(),
                     [](const fs::directory_entry& e) { return e.path().filename() == kLockName; });
}

void Empty(const fs::path& root) {
  for (const auto& entry : fs::directory_iterator(root)) {
    if (entry.path().filename() != kLockName) fs::remove_all(entry.path());
  }
}

}  // namespace

OutputLock::OutputLock(const fs::path& root) {
  std::error_code code;
  fs::create_directories(root, code);
  const fs::path path = root / kLockName;
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw DataError(fmt::format("{}: cannot write to the output folder: {}", root.string(),
                                std::strerror(errno)));
  }
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor_);
    throw DataError(fmt::format("{}: another rigmap is working in this folder", root.string()));
  }
}

OutputLock::~OutputLock() { close(descriptor_); }

void ClaimOutput(const OutputLayout& layout, const std::string& identity, bool force) {
  const fs::path mark = layout.root / kIdentityName;
  if (force) {
    Empty(layout.root);
  } else if (!IsEmpty(layout.root)) {
    if (!fs::exists(mark)) {
      throw DataError(fmt::format(
          "{}: the output folder is not empty and holds no results of rigmap; choose another, or "
          "--force to empty it",
          layout.root.string()));
    }
    const std::string found = ReadTextFile(mark);
    if (found != identity + "\n") {
      throw DataError(
          fmt::format("{}: expected results of {}, found those of {}; choose another folder, or "
                      "--force to start anew",
                      layout.root.string(), identity, found.substr(0, found.find('\n'))));
    }
  }
  WriteFileAtomically(mark, [&](std::ostream& stream) { stream << identity << '\n'; });
}

}  // namespace rigmap
