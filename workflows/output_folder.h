// The folder that a part's results go to: its lock, whose it is, and what may be taken away.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset_content.h"
#include "scene/dataset.h"

namespace rigmap {

// Of a joined traverse: its worlds beside the largest, each in a folder of its own.
inline constexpr const char* kWorldsFolder = "worlds";

// Whose results a folder holds, kept in it as `.dataset`.
struct FolderMark {
  std::string frames;       // DatasetContent::FramesKey
  std::string description;  // for people: "35 pairs from ..."
};

FolderMark MarkOf(const Dataset& dataset, const DatasetContent& content);
// That a folder bears; nothing where it bears none, or one of an older rigmap.
std::optional<FolderMark> MarkIn(const std::filesystem::path& root);

// Holds the folder for this process alone until destroyed (flock, not inherited by children).
class OutputLock {
 public:
  // Creates the folder. Throws DataError when it cannot be written or another process holds it.
  explicit OutputLock(const std::filesystem::path& root);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  int descriptor_ = -1;
};

// Throws DataError if a comparison may not be put into the folder: it holds something, and no
// comparison.
void RequireComparisonOutput(const std::filesystem::path& root);

// Throws DataError if a traverse's parts may not be put into the folder: it holds something, and
// neither bears rigmap's mark nor holds parts.
void RequireTraverseOutput(const std::filesystem::path& root);

// Throws DataError if the folder is that of one of the parts, lies in one, or holds one elsewhere
// than a traverse does.
void RequirePartsElsewhere(const std::filesystem::path& root,
                           const std::vector<std::filesystem::path>& parts);

// Throws DataError if one of the dataset's files lies in the folder, or the folder among its
// images.
void RequireInputElsewhere(const std::filesystem::path& root, const Dataset& dataset);

// Throws DataError if a run may not write here:
// - the folder holds anything and does not bear rigmap's mark;
// - it holds what was made from other frames, unless `force`;
// - `force` would take away what rigmap did not write.
// Writes nothing: to be called before the lock, so that a folder that is refused stays as it is.
void RequireOwnOutput(const std::filesystem::path& root, const FolderMark& mark, bool force);

// Marks the locked folder, after RequireOwnOutput; with `force` everything that rigmap wrote is
// removed first. An earlier run's summary.json, config.yaml and report.html are removed: while they
// are missing, a run is at work or was killed.
void ClaimOutput(const std::filesystem::path& root, const FolderMark& mark, bool force);

}  // namespace rigmap
