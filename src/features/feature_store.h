// Features of all frames as files, read when they are asked for.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "features/rig_fixed.h"
#include "scene/features.h"

namespace rigmap {

// The file of one frame's features, and the key that it was kept under.
struct FeatureFile {
  std::filesystem::path path;
  std::string key;
};

// Keeps the features of the sixteen frames that were used last (2 MB each). May be asked by several
// threads at once.
class FeatureStore {
 public:
  // Features in cells of `rig_fixed` are left out.
  FeatureStore(std::vector<FeatureFile> files, RigFixedCells rig_fixed);
  ~FeatureStore();
  FeatureStore(FeatureStore&&) noexcept;
  FeatureStore& operator=(FeatureStore&&) noexcept;

  // Throws DataError when the file is gone or damaged.
  FrameFeatures Get(int frame) const;
  // The same as a function; this must outlive it.
  FeatureSource AsSource() const;
  int frame_count() const;
  const RigFixedCells& rig_fixed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rigmap
