#include "fusion/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/progress.h"
#include "fusion/internal/carried_cells.h"
#include "fusion/internal/covering_views.h"
#include "fusion/internal/frame_agreement.h"
#include "fusion/internal/layered_grid.h"
#include "fusion/internal/past_light.h"
#include "fusion/internal/view_cache.h"
#include "fusion/internal/view_consistency.h"

namespace rigmap {
namespace {

std::vector<Rigid3> PosesOf(std::span<const PosedDepth> depths) {
  std::vector<Rigid3> poses;
  for (const PosedDepth& depth : depths) poses.push_back(depth.world_from_left);
  return poses;
}

void Brighten(double factor, std::vector<SurfaceSample>& samples) {
  for (SurfaceSample& sample : samples) {
    for (std::uint8_t& value : sample.rgb) {
      value = static_cast<std::uint8_t>(std::clamp(std::lround(factor * value), 0L, 255L));
    }
  }
}

constexpr int kBand = 256;  // rows; their samples are in memory at once

// Nobody could confirm it or be averaged with it: each pixel is a point.
void TakeSingle(const DepthView& view, FusionOptions options, const FusionTarget& target) {
  options.min_views = 1;
  options.max_sigma_pct = std::numeric_limits<double>::infinity();
  for (int row = 0; row < view.map.disparity.rows; row += kBand) {
    PointCloud points;
    for (const SurfaceSample& sample : ConfirmedSamples(view, {}, options, {row, row + kBand})) {
      const float sigma_m = sample.OffSurfaceM();
      if (options.max_sigma_m > 0.0 && sigma_m > options.max_sigma_m) continue;
      points.push_back({.x_in_world = sample.x_in_world.cast<float>(),
                        .normal = sample.normal,
                        .rgb = sample.rgb,
                        .observations = 1,
                        .sigma_m = sigma_m,
                        .grain_m = sample.pixel_m});
    }
    target.take(points);
  }
}

// Those of a sound frame, compared with those that are sound.
void AddSamplesOf(std::size_t frame, std::span<const Rigid3> world_from_left,
                  const FusionOptions& options, FrameAgreement& agreement, ViewCache& cache,
                  PastLight& past_light, LayeredGrid& grid) {
  FrameComparison compared = agreement.ComparisonOf(frame);
  const auto is_unsound = [&](std::size_t other) { return !agreement.IsSound(other); };
  std::erase_if(compared.near, is_unsound);
  const std::size_t near = compared.near.size();
  compared.near.insert(compared.near.end(), compared.further.begin(), compared.further.end());
  compared.near =
      CoveringViews(*cache.Get({&frame, 1}).front(), compared.near, world_from_left, near);
  std::erase_if(compared.near, is_unsound);
  std::erase_if(compared.ahead, is_unsound);
  const double brightness = agreement.BrightnessFor(frame);
  std::vector<std::size_t> frames{frame};
  frames.insert(frames.end(), compared.near.begin(), compared.near.end());
  frames.insert(frames.end(), compared.ahead.begin(), compared.ahead.end());
  const auto views = cache.Get(frames);
  const auto first_ahead = views.begin() + 1 + static_cast<std::ptrdiff_t>(compared.near.size());
  const ComparedViews others{{views.begin() + 1, first_ahead}, {first_ahead, views.end()}};
  DepthView own = *views[0];  // shares its images
  own.map.colour = past_light.Lit(own, brightness);
  for (int row = 0; row < own.map.disparity.rows; row += kBand) {
    auto samples = ConfirmedSamples(own, others, options, {row, row + kBand});
    Brighten(brightness, samples);
    grid.Add(samples);
  }
}

}  // namespace

std::vector<std::size_t> FuseDepthMaps(std::span<const PosedDepth> depths, double voxel_m,
                                       const FusionOptions& options, const FusionTarget& target,
                                       std::size_t cached_views) {
  RequireValid(options);
  const std::vector<Rigid3> world_from_left = PosesOf(depths);
  ViewCache cache(depths, cached_views);
  if (depths.size() == 1) {
    const std::size_t first = 0;
    TakeSingle(*cache.Get({&first, 1}).front(), options, target);
    return {};
  }
  if (cv::Mat carried = CarriedByTheRig(world_from_left, options, cache); !carried.empty()) {
    cache.Hide(std::move(carried));
  }
  FrameAgreement agreement(world_from_left, options, cache);
  PastLight past_light;
  LayeredGrid grid(voxel_m, options.steep_voxel_share, target.scratch, kKeptVoxels);
  std::vector<std::size_t> left_out;
  Progress progress("fusion", depths.size());
  for (std::size_t frame = 0; frame < depths.size(); ++frame) {
    if (agreement.IsSound(frame)) {
      AddSamplesOf(frame, world_from_left, options, agreement, cache, past_light, grid);
    } else {
      left_out.push_back(frame);
    }
    progress.Advance();
  }
  grid.Drain(options, target.take);
  return left_out;
}

}  // namespace rigmap
