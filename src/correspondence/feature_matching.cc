#include "correspondence/feature_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>
#include <unordered_map>

#include "geometry/tile_index.h"

namespace rigmap {
namespace {

int SquaredDistance(const Descriptor& a, const Descriptor& b) {
  using Bytes = cv::v_uint8x16;
  static_assert(kDescriptorSize % Bytes::nlanes == 0);
  cv::v_uint32x4 sum = cv::v_setzero_u32();
  for (int i = 0; i < kDescriptorSize; i += Bytes::nlanes) {
    const Bytes difference = cv::v_absdiff(cv::v_load(a.data() + i), cv::v_load(b.data() + i));
    sum += cv::v_dotprod_expand_fast(difference, difference);
  }
  return static_cast<int>(cv::v_reduce_sum(sum));
}

struct Best {
  int index = -1;
  int distance = std::numeric_limits<int>::max();
  int second = std::numeric_limits<int>::max();

  void Offer(int candidate, int squared) {
    if (squared < distance) {
      second = distance;
      distance = squared;
      index = candidate;
    } else {
      second = std::min(second, squared);
    }
  }
};

// Described features of a frame by the cell their left pixel falls into; cells are as wide as the
// radius, so that the nine around a place hold everything within it.
class PixelGrid {
 public:
  PixelGrid(const FrameFeatures& frame, double cell_px) : cell_px_(cell_px) {
    for (std::size_t i = 0; i < frame.descriptors.size(); ++i) {
      cells_[TileAt(frame.features[i].left, cell_px_)].push_back(static_cast<int>(i));
    }
  }

  template <class Visit>
  void Near(const Eigen::Vector2d& pixel, const Visit& visit) const {
    // A point beside the camera may be predicted anywhere.
    const auto [x, y] = TileAt(pixel, cell_px_);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto cell = cells_.find({x + dx, y + dy});
        if (cell == cells_.end()) continue;
        for (int index : cell->second) visit(index);
      }
    }
  }

 private:
  double cell_px_;
  std::unordered_map<TileIndex, std::vector<int>, TileHash> cells_;
};

// `ForCandidates(i, visit)` calls visit(j) for every feature j of b that feature i of a may match.
template <class ForCandidates>
std::vector<FeatureMatch> MutualBest(const FrameFeatures& a, const FrameFeatures& b,
                                     const ForCandidates& for_candidates,
                                     const FeatureMatchOptions& options) {
  std::vector<Best> of_a(a.descriptors.size()), of_b(b.descriptors.size());
  for (std::size_t i = 0; i < a.descriptors.size(); ++i) {
    for_candidates(i, [&](int j) {
      const int squared = SquaredDistance(a.descriptors[i], b.descriptors[j]);
      of_a[i].Offer(j, squared);
      of_b[j].Offer(static_cast<int>(i), squared);
    });
  }
  const double max_squared = options.max_distance * options.max_distance;
  const double max_squared_ratio = options.max_ratio * options.max_ratio;
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const Best& best = of_a[i];
    if (best.index < 0 || of_b[best.index].index != static_cast<int>(i)) continue;
    if (best.distance > max_squared) continue;
    // "Not less" rather than "more": of two perfect twins neither is the one.
    if (best.distance >= max_squared_ratio * std::min(best.second, of_b[best.index].second)) {
      continue;
    }
    matches.push_back({static_cast<int>(i), best.index});
  }
  return matches;
}

}  // namespace

std::vector<FeatureMatch> MatchFeatures(const FrameFeatures& a, const FrameFeatures& b,
                                        const FeatureMatchOptions& options) {
  const auto all = [&](std::size_t, const auto& visit) {
    for (std::size_t j = 0; j < b.descriptors.size(); ++j) visit(static_cast<int>(j));
  };
  return MutualBest(a, b, all, options);
}

std::vector<FeatureMatch> MatchFeatures(const FrameFeatures& a, const FrameFeatures& b,
                                        std::span<const int> groups_of_a,
                                        std::span<const int> groups_of_b,
                                        const FeatureMatchOptions& options) {
  std::unordered_map<int, std::vector<int>> members;  // of b's groups
  for (std::size_t j = 0; j < groups_of_b.size(); ++j) {
    members[groups_of_b[j]].push_back(static_cast<int>(j));
  }
  const auto of_same_group = [&](std::size_t i, const auto& visit) {
    const auto group = members.find(groups_of_a[i]);
    if (group == members.end()) return;
    for (const int j : group->second) visit(j);
  };
  return MutualBest(a, b, of_same_group, options);
}

std::vector<FeatureMatch> MatchFeatures(
    const FrameFeatures& a, const FrameFeatures& b,
    std::span<const std::optional<Eigen::Vector2d>> predicted_in_b, double radius_px,
    const FeatureMatchOptions& options) {
  const PixelGrid grid(b, radius_px);
  const auto near_prediction = [&](std::size_t i, const auto& visit) {
    if (!predicted_in_b[i]) return;
    grid.Near(*predicted_in_b[i], [&](int j) {
      if ((b.features[j].left - *predicted_in_b[i]).squaredNorm() <= radius_px * radius_px)
        visit(j);
    });
  };
  return MutualBest(a, b, near_prediction, options);
}

std::vector<FeatureMatch> MatchTracks(const FrameFeatures& a, const FrameFeatures& b) {
  std::unordered_map<std::int64_t, int> in_b;
  for (std::size_t i = 0; i < b.tracks.size(); ++i) {
    in_b.emplace(b.tracks[i], static_cast<int>(i));
  }
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < a.tracks.size(); ++i) {
    const auto found = in_b.find(a.tracks[i]);
    if (found != in_b.end()) matches.push_back({static_cast<int>(i), found->second});
  }
  return matches;
}

}  // namespace rigmap
