// Depth maps in memory, as many as fit.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "fusion/depth_fusion.h"
#include "fusion/internal/view_consistency.h"

namespace rigmap {

// Keeps the depth maps used last. Not thread-safe.
class ViewCache {
 public:
  // `depths` must outlive this. Up to `capacity` maps, 11 bytes per pixel each; more only where
  // more are asked for at once.
  ViewCache(std::span<const PosedDepth> depths, std::size_t capacity)
      : depths_(depths), capacity_(capacity) {}

  // From now on no map knows a depth where `mask` (CV_8UC1, of the rectified views) is not 0.
  void Hide(cv::Mat mask);

  // They stay valid until the next call. Throws DataError when a depth map is missing.
  std::vector<const DepthView*> Get(std::span<const std::size_t> frames);

 private:
  struct Entry {
    DepthView view;
    std::uint64_t last_use = 0;
  };

  std::span<const PosedDepth> depths_;
  std::size_t capacity_;
  cv::Mat hidden_;  // empty: nothing
  std::map<std::size_t, Entry> entries_;
  std::uint64_t time_ = 0;
};

}  // namespace rigmap
