#include "workflows/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "core/stamp.h"
#include "workflows/recipes.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr const char* kLockName = ".lock";
// In the root itself, so that a run that is killed while it claims an empty folder leaves nothing
// in it but what IsEmpty knows.
constexpr const char* kMarkName = ".dataset";

// Beside what the techniques publish.
constexpr const char* kOwnNames[] = {kLockName, kMarkName,     "summary.json", "config.yaml",
                                     "logs",    "report.html", "stages"};

// Of a traverse, beside what is made of the whole: what its parts are and were made from. No run on
// the whole takes them away.
constexpr const char* kTraverseNames[] = {"parts", "plan.json", "jobs", "rig.yaml", kWorldsFolder};

bool IsOfTraverse(const fs::path& name) {
  return std::ranges::count(kTraverseNames, name.string()) > 0;
}

bool IsUnfinishedMark(const fs::path& name) {
  return name.stem() == kMarkName && IsTemporaryName(name);
}

bool IsEmpty(const fs::path& root) {
  return std::all_of(fs::directory_iterator(root), fs::directory_iterator(), [](const auto& entry) {
    const auto name = entry.path().filename();
    return name == kLockName || IsUnfinishedMark(name) || IsOfTraverse(name);
  });
}

// Names in the folder that rigmap may have written.
std::set<std::string> OwnNames() {
  std::set<std::string> names(std::begin(kOwnNames), std::end(kOwnNames));
  for (const std::string& output : KnownOutputs()) names.insert(*fs::path(output).begin());
  return names;
}

bool IsOwn(const fs::path& entry, const std::set<std::string>& own) {
  const std::string name = entry.filename().string();
  return own.contains(name) || IsTemporaryName(name) || IsOfTraverse(name);
}

void RequireNothingForeign(const fs::path& root) {
  const std::set<std::string> own = OwnNames();
  for (const auto& entry : fs::directory_iterator(root)) {
    if (IsOwn(entry.path(), own)) continue;
    throw DataError(
        fmt::format("{}: --force would remove {}, which rigmap did not write; move it elsewhere",
                    root.string(), entry.path().filename().string()));
  }
}

// Folders that no mark makes an output folder.
void RequireNoHome(const fs::path& root) {
  const fs::path whole = fs::weakly_canonical(root);
  const char* home = std::getenv("HOME");
  const passwd* user = getpwuid(getuid());
  if (whole == whole.root_path() || (home && whole == fs::weakly_canonical(home)) ||
      (user && whole == fs::weakly_canonical(user->pw_dir)) || whole.parent_path() == "/home") {
    throw DataError(fmt::format("{}: a home or the root is no output folder", root.string()));
  }
}

// The mark stays until it is written anew: a run killed here leaves a folder that bears one.
void Empty(const fs::path& root) {
  for (const auto& entry : fs::directory_iterator(root)) {
    const fs::path name = entry.path().filename();
    if (name == kLockName || name == kMarkName || IsOfTraverse(name)) continue;
    fs::remove_all(entry.path());
  }
}

std::string MarkText(const FolderMark& mark) {
  return fmt::format("results of rigmap\nframes {}\n{}\n", mark.frames, mark.description);
}

// Nothing where it was not written by this kind of rigmap.
std::optional<FolderMark> ReadMark(const fs::path& path) {
  std::istringstream text(ReadTextFile(path));
  std::string title, frames;
  FolderMark mark;
  std::getline(text, title);
  std::getline(text, frames);
  std::getline(text, mark.description);
  if (title != "results of rigmap" || !frames.starts_with("frames ")) return std::nullopt;
  mark.frames = frames.substr(7);
  return mark;
}

bool LiesIn(const fs::path& file, const fs::path& folder) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(file, ignored);
  const fs::path above = fs::weakly_canonical(folder, ignored);
  if (above.empty()) return false;  // a link that leads to itself, say
  return std::mismatch(above.begin(), above.end(), whole.begin(), whole.end()).first == above.end();
}

}  // namespace

FolderMark MarkOf(const Dataset& dataset, const DatasetContent& content) {
  const auto& frames = dataset.frames;
  return {content.FramesKey(), fmt::format("{} pairs from {} to {} s", frames.size(),
                                           FormatSeconds(frames.front().stamp_ns),
                                           FormatSeconds(frames.back().stamp_ns))};
}

std::optional<FolderMark> MarkIn(const fs::path& root) {
  return fs::exists(root / kMarkName) ? ReadMark(root / kMarkName) : std::nullopt;
}

OutputLock::OutputLock(const fs::path& root) {
  RequireNoHome(root);
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

void RequireTraverseOutput(const fs::path& root) {
  if (fs::is_directory(root) && !IsEmpty(root) && fs::exists(root / kMarkName)) return;
  RequireOwnOutput(root, {}, false);
}

void RequireComparisonOutput(const fs::path& root) {
  std::error_code ignored;
  if (!fs::exists(root, ignored)) return;
  if (!fs::is_directory(root, ignored)) {
    throw DataError(fmt::format("{}: expected an output folder, found a file", root.string()));
  }
  RequireNoHome(root);
  const bool is_ours = fs::exists(root / "comparison.json") || fs::is_directory(root / "runs");
  if (IsEmpty(root) || (is_ours && !fs::exists(root / kMarkName))) return;
  throw DataError(fmt::format(
      "{}: the output folder is not empty and holds no comparison of rigmap; choose another",
      root.string()));
}

void RequirePartsElsewhere(const fs::path& root, const std::vector<fs::path>& parts) {
  for (const fs::path& part : parts) {
    const bool is_held = LiesIn(part, root) && !LiesIn(part, root / kTraverseNames[0]);
    if (!is_held && !LiesIn(root, part)) continue;
    throw DataError(
        fmt::format("{}: expected an output folder apart from the parts, found {} in {}",
                    root.string(), is_held ? part.string() : "it", is_held ? "it" : part.string()));
  }
}

void RequireOwnOutput(const fs::path& root, const FolderMark& mark, bool force) {
  std::error_code ignored;
  if (!fs::exists(root, ignored)) return;
  if (!fs::is_directory(root, ignored)) {
    throw DataError(fmt::format("{}: expected an output folder, found a file", root.string()));
  }
  RequireNoHome(root);
  if (IsEmpty(root)) return;
  if (!fs::exists(root / kMarkName)) {
    throw DataError(
        fmt::format("{}: the output folder is not empty and holds no results of rigmap; choose "
                    "another",
                    root.string()));
  }
  if (force) return RequireNothingForeign(root);
  const auto found = ReadMark(root / kMarkName);
  if (found && found->frames == mark.frames) return;
  throw DataError(fmt::format(
      "{}: holds results of other frames ({}) than those asked for ({}); choose another "
      "folder, or --force to remove them and start anew",
      root.string(), found ? found->description : "of an older rigmap", mark.description));
}

void RequireInputElsewhere(const fs::path& root, const Dataset& dataset) {
  std::vector<std::string> files{dataset.rig.source, dataset.truth_path, dataset.rig.left.mask_path,
                                 dataset.rig.right.mask_path};
  std::set<fs::path> image_folders;
  for (const StereoFrame& frame : dataset.frames) {
    for (const Eye eye : kEyes) {
      files.push_back(frame.PathOf(eye));
      image_folders.insert(fs::path(frame.PathOf(eye)).parent_path());
    }
  }
  for (const std::string& file : files) {
    if (!file.empty() && LiesIn(file, root)) {
      throw DataError(fmt::format("{}: the output folder holds the input {}; choose another",
                                  root.string(), file));
    }
  }
  for (const fs::path& folder : image_folders) {
    if (LiesIn(root, folder)) {
      throw DataError(
          fmt::format("{}: the output folder lies among the images in {}; choose another",
                      root.string(), folder.string()));
    }
  }
}

void ClaimOutput(const fs::path& root, const FolderMark& mark, bool force) {
  if (force) Empty(root);
  for (const char* name : {"summary.json", "config.yaml", "report.html"}) fs::remove(root / name);
  WriteFileAtomically(root / kMarkName, [&](std::ostream& stream) { stream << MarkText(mark); });
}

}  // namespace rigmap
