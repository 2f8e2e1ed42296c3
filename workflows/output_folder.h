// The folder that a part's results go to: its layout, its lock, and whose it is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

struct OutputLayout {
  std::filesystem::path root;

  std::filesystem::path Artefact(const std::string& stage) const {
    return root / "stages" / (stage + ".bin");
  }
  // What is kept of a single frame.
  std::filesystem::path FeaturesOf(const StereoFrame& frame) const {
    return root / "stages" / "features" / (std::to_string(frame.stamp_ns) + ".bin");
  }
  std::filesystem::path DepthOf(const StereoFrame& frame) const {
    return root / "stages" / "dense" / (std::to_string(frame.stamp_ns) + ".bin");
  }
  std::filesystem::path Scratch() const { return root / "stages" / "scratch"; }
  std::filesystem::path Log(const std::string& stage) const {
    return root / "logs" / (stage + ".log");
  }
  std::filesystem::path Database() const { return root / "colmap" / "database.db"; }
  std::filesystem::path Images() const { return root / "colmap" / "images"; }
  std::filesystem::path Models() const { return root / "colmap" / "models"; }
  std::filesystem::path Sparse() const { return root / "sparse"; }
  std::filesystem::path RefinedRig() const { return root / "rig_refined.yaml"; }

  // All that a stage may leave for users.
  std::vector<std::filesystem::path> PublishedBy(const std::string& stage) const;
};

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

// Throws DataError if the folder holds something else than results of the same data, which
// `identity` names (a line). With `force` anything may be in it but the input itself. Writes
// nothing: to be called before the lock, so that a folder that is refused stays as it is.
void RequireOwnOutput(const OutputLayout& layout, const std::string& identity, bool force);

// Throws DataError if one of the dataset's files lies in the folder, which --force would empty.
void RequireInputElsewhere(const OutputLayout& layout, const Dataset& dataset);

// Marks the locked folder as that of `identity`, after RequireOwnOutput; with `force` everything in
// it but the lock is removed first. An earlier run's summary.json and config.yaml are removed:
// while they are missing, a run is at work or was killed.
void ClaimOutput(const OutputLayout& layout, const std::string& identity, bool force);

}  // namespace rigmap
