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
// In the root itself, so that a run that is killed while it claims an empty folder leaves nothing
// in it but what IsEmpty knows.
constexpr const char* kIdentityName = ".dataset";

bool IsEmpty(const fs::path& root) {
  return std::all_of(fs::directory_iterator(root), fs::directory_iterator(), [](const auto& entry) {
    const auto name = entry.path().filename();
    return name == kLockName || (name.stem() == kIdentityName && IsTemporaryName(name));
  });
}

void Empty(const fs::path& root) {
  for (const auto& entry : fs::directory_iterator(root)) {
    if (entry.path().filename() != kLockName) fs::remove_all(entry.path());
  }
}

bool LiesIn(const fs::path& file, const fs::path& folder) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(file, ignored);
  const fs::path above = fs::weakly_canonical(folder, ignored);
  return std::mismatch(above.begin(), above.end(), whole.begin(), whole.end()).first == above.end();
}

}  // namespace

std::vector<fs::path> OutputLayout::PublishedBy(const std::string& stage) const {
  if (stage == "database") return {Database(), Images()};
  if (stage == "mapping") return {Models()};
  if (stage == "adjustment") {
    return {root / "trajectory.tum",
            root / "trajectory.csv",
            root / "trajectory_midpoint.tum",
            root / "trajectory_antenna.tum",
            RefinedRig(),
            Sparse(),
            root / "sparse.ply"};
  }
  if (stage == "fusion") {
    return {root / "dense.ply",    root / "height.tif",    root / "ortho.tif",
            root / "view_top.png", root / "view_side.png", root / "view_oblique.png"};
  }
  if (stage == "evaluation") return {root / "evaluation.json"};
  return {};
}

OutputLock::OutputLock(const fs::path& root) {
  std::error_code code;
  fs::create_directories(root, code);
  if (code) {
    throw DataError(
        fmt::format("{}: cannot write to the output folder: {}", root.string(), code.message()));
  }
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

void RequireOwnOutput(const OutputLayout& layout, const std::string& identity, bool force) {
  std::error_code ignored;
  if (!fs::exists(layout.root, ignored)) return;
  if (!fs::is_directory(layout.root, ignored)) {
    throw DataError(
        fmt::format("{}: expected an output folder, found a file", layout.root.string()));
  }
  if (force || IsEmpty(layout.root)) return;
  const fs::path mark = layout.root / kIdentityName;
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

void RequireInputElsewhere(const OutputLayout& layout, const Dataset& dataset) {
  std::vector<std::string> files{dataset.rig.source, dataset.truth_path, dataset.rig.left.mask_path,
                                 dataset.rig.right.mask_path};
  for (const StereoFrame& frame : dataset.frames) {
    files.insert(files.end(), {frame.left_path, frame.right_path});
  }
  for (const std::string& file : files) {
    if (!file.empty() && LiesIn(file, layout.root)) {
      throw DataError(fmt::format("{}: the output folder holds the input {}; choose another",
                                  layout.root.string(), file));
    }
  }
}

void ClaimOutput(const OutputLayout& layout, const std::string& identity, bool force) {
  RequireOwnOutput(layout, identity, force);
  if (force) Empty(layout.root);
  for (const char* name : {"summary.json", "config.yaml"}) fs::remove(layout.root / name);
  WriteFileAtomically(layout.root / kIdentityName,
                      [&](std::ostream& stream) { stream << identity << '\n'; });
}

}  // namespace rigmap
