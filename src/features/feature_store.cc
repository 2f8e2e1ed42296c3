#include "features/feature_store.h"

#include <fmt/format.h>

#include <list>
#include <mutex>

#include "core/artefact.h"
#include "core/error.h"

namespace rigmap {
namespace {

constexpr std::size_t kKeptFrames = 16;

}  // namespace

struct FeatureStore::State {
  std::vector<FeatureFile> files;
  RigFixedCells rig_fixed;
  std::mutex mutex;
  std::list<std::pair<int, FrameFeatures>> kept;  // used last first
};

FeatureStore::FeatureStore(std::vector<FeatureFile> files, RigFixedCells rig_fixed)
    : state_(std::make_unique<State>()) {
  state_->files = std::move(files);
  state_->rig_fixed = std::move(rig_fixed);
}

FeatureStore::~FeatureStore() = default;
FeatureStore::FeatureStore(FeatureStore&&) noexcept = default;
FeatureStore& FeatureStore::operator=(FeatureStore&&) noexcept = default;

FrameFeatures FeatureStore::Get(int frame) const {
  State& state = *state_;
  {
    const std::lock_guard lock(state.mutex);
    for (auto it = state.kept.begin(); it != state.kept.end(); ++it) {
      if (it->first != frame) continue;
      state.kept.splice(state.kept.begin(), state.kept, it);
      return it->second;
    }
  }
  const FeatureFile& file = state.files[static_cast<std::size_t>(frame)];
  auto features = ReadArtefact<FrameFeatures>(file.path, file.key);
  if (!features) {
    throw DataError(
        fmt::format("{}: expected the features of a frame, found a damaged file; "
                    "run the part again",
                    file.path.string()));
  }
  state.rig_fixed.RemoveFrom(*features);
  const std::lock_guard lock(state.mutex);
  state.kept.emplace_front(frame, *features);
  if (state.kept.size() > kKeptFrames) state.kept.pop_back();
  return std::move(*features);
}

FeatureSource FeatureStore::AsSource() const {
  return [this](int frame) { return Get(frame); };
}

const RigFixedCells& FeatureStore::rig_fixed() const { return state_->rig_fixed; }

int FeatureStore::frame_count() const { return static_cast<int>(state_->files.size()); }

}  // namespace rigmap
