#include "fusion/internal/view_cache.h"

#include <algorithm>
#include <utility>

namespace rigmap {
namespace {

DepthView Load(const PosedDepth& depth) {
  DepthMap map = ReadDepth(depth.path, depth.key);
  const Rigid3 world_from_rectified = depth.world_from_left * map.left_from_rectified;
  return {std::move(map), world_from_rectified};
}

}  // namespace

void ViewCache::Hide(cv::Mat mask) {
  hidden_ = std::move(mask);
  for (auto& [frame, entry] : entries_) entry.view.map.disparity.setTo(0.0F, hidden_);
}

std::vector<const DepthView*> ViewCache::Get(std::span<const std::size_t> frames) {
  ++time_;
  std::vector<std::size_t> missing;
  for (const std::size_t frame : frames) {
    const auto entry = entries_.find(frame);
    if (entry == entries_.end()) {
      missing.push_back(frame);
    } else {
      entry->second.last_use = time_;
    }
  }
  for (const std::size_t frame : missing) {
    while (!entries_.empty() && entries_.size() >= capacity_) {
      const auto oldest = std::min_element(
          entries_.begin(), entries_.end(),
          [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
      if (oldest->second.last_use == time_) break;
      entries_.erase(oldest);
    }
    Entry& entry = entries_.try_emplace(frame, Entry{Load(depths_[frame]), time_}).first->second;
    if (!hidden_.empty()) entry.view.map.disparity.setTo(0.0F, hidden_);
  }
  std::vector<const DepthView*> views;
  for (const std::size_t frame : frames) views.push_back(&entries_.at(frame).view);
  return views;
}

}  // namespace rigmap
