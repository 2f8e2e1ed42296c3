#include "fusion/depth_fusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "fusion/view_consistency.h"
#include "fusion/voxel_grid.h"

namespace rigmap {
namespace {

DepthView Load(const PosedDepth& depth) {
  std::optional<DepthMap> map = LoadDepth(depth.path, depth.key);
  if (!map) {
    throw DataError(fmt::format("{}: expected the depth map with key {}, found none",
                                depth.path.string(), depth.key));
  }
  const Rigid3 world_from_rectified = depth.world_from_left * map->left_from_rectified;
  return {std::move(*map), world_from_rectified};
}

// The frames that are nearest in place and look the same way, nearest first.
std::vector<std::size_t> NeighboursOf(std::size_t reference, std::span<const PosedDepth> depths,
                                      const FusionOptions& options) {
  const Rigid3& own = depths[reference].world_from_left;
  const double least_cosine = std::cos(options.max_neighbour_angle_deg * std::numbers::pi / 180.0);
  std::vector<std::pair<double, std::size_t>> candidates;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const Rigid3& other = depths[i].world_from_left;
    const double cosine =
        (own.rotation * Eigen::Vector3d::UnitZ()).dot(other.rotation * Eigen::Vector3d::UnitZ());
    if (i == reference || cosine < least_cosine) continue;
    candidates.emplace_back((own.translation - other.translation).norm(), i);
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(options.neighbours)));
  std::vector<std::size_t> neighbours;
  for (const auto& [distance_m, i] : candidates) neighbours.push_back(i);
  return neighbours;
}

// The depth maps in memory: those that the present frame asks for, no others.
class LoadedViews {
 public:
  explicit LoadedViews(std::span<const PosedDepth> depths) : depths_(depths) {}

  void Keep(const std::vector<std::size_t>& wanted) {
    std::erase_if(views_, [&](const auto& entry) {
      return std::find(wanted.begin(), wanted.end(), entry.first) == wanted.end();
    });
    for (const std::size_t i : wanted) {
      if (!views_.contains(i)) views_.emplace(i, Load(depths_[i]));
    }
  }
  const DepthView& At(std::size_t i) const { return views_.at(i); }

 private:
  std::span<const PosedDepth> depths_;
  std::map<std::size_t, DepthView> views_;
};

}  // namespace

PointCloud FuseDepthMaps(std::span<const PosedDepth> depths, const FusionOptions& options) {
  options.Validate();
  VoxelGrid grid(options.voxel_m);
  LoadedViews views(depths);
  Progress progress("fusion", depths.size());
  for (std::size_t reference = 0; reference < depths.size(); ++reference) {
    std::vector<std::size_t> wanted = NeighboursOf(reference, depths, options);
    wanted.push_back(reference);
    views.Keep(wanted);
    wanted.pop_back();
    std::vector<const DepthView*> neighbours;
    for (const std::size_t i : wanted) neighbours.push_back(&views.At(i));
    for (const SurfaceSample& sample : ConfirmedSamples(views.At(reference), neighbours, options)) {
      grid.Add(sample);
    }
    progress.Advance();
  }
  return grid.Points(options.min_observations);
}

}  // namespace rigmap
