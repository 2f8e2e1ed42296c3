#include "workflows/stages/fusion.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "core/memory_peak.h"
#include "core/memory_share.h"
#include "export/ply.h"
#include "fusion/depth_fusion.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

// How many depth maps are compared at once.
std::size_t ComparedViews(std::size_t frames, const FusionOptions& options) {
  return std::min(frames, static_cast<std::size_t>(1 + options.neighbours + options.ahead));
}

// How many depth maps stay in memory within what --memory allows the whole process.
std::size_t CachedViews(const DepthIndex& depths, const FusionOptions& options,
                        const StageContext& context) {
  const std::size_t compared = ComparedViews(depths.frames.size(), options);
  const double least_mb =
      ResidentMegabytes() + kFusionMegabytes + static_cast<double>(compared) * depths.view_mb;
  if (least_mb > context.memory_mb) {
    spdlog::warn(
        "fusion takes {:.0f} MB, for {} depth maps of {:.0f} MB at once: more than --memory, {}",
        least_mb, compared, depths.view_mb, context.memory_mb);
  }
  const double fitting = (MemoryShare(context.memory_mb) - kFusionMegabytes) / depths.view_mb;
  return static_cast<std::size_t>(
      std::max<double>(static_cast<double>(compared), std::min<double>(kCachedViews, fitting)));
}

// What is not written then is left out by the stages that would.
std::string EmptyMapRemark(const FusedMap& map) {
  if (map.frames == 0) return "the map is empty: no frame is posed well enough to show in it";
  return fmt::format(
      "the map is empty, without rasters, pictures and dense.las: nothing in {} depth maps is "
      "known well enough; look at the options of dense and fusion that are not the default",
      map.frames);
}

FusedMap MakeMap(const StageContext& context, const Dataset&, const PosedPart& part,
                 const DepthIndex& depths, const FusionOptions& asked) {
  std::vector<PosedDepth> posed;
  for (std::size_t i = 0; i < depths.frames.size(); ++i) {
    const int frame = depths.frames[i];
    posed.push_back({depths.files[i].In(context.root), depths.files[i].key,
                     part.trajectory[frame].world_from_left});
  }
  FusionOptions options = asked;
  options.min_views = std::min(options.min_views, std::max(1, static_cast<int>(posed.size())));
  FusedMap fused;
  fused.voxel_m = depths.voxel_m;
  fused.frames = static_cast<int>(posed.size());
  if (posed.size() > 1) fused.max_sigma_pct = options.max_sigma_pct;
  if (options.max_sigma_m > 0.0) fused.max_sigma_m = options.max_sigma_m;
  context.publication->File("dense.ply", [&](std::ostream& stream) {
    PlyWriter writer(stream);
    const auto take = [&](std::span<const SurfacePoint> points) { writer.Write(points); };
    for (const std::size_t i :
         FuseDepthMaps(posed, depths.voxel_m, options, {context.scratch / "tiles", take},
                       CachedViews(depths, options, context))) {
      fused.frames_left_out.push_back(depths.frames[i]);
    }
    writer.Finish();
    fused.points = writer.point_count();
  });
  if (fused.points == 0) spdlog::warn("{}", EmptyMapRemark(fused));
  return fused;
}

}  // namespace

Report DescribeMap(const FusedMap& map, const Dataset& dataset, const PosedPart&,
                   const DepthIndex&) {
  Report remarks = Report::array();
  if (map.points == 0) remarks.push_back(EmptyMapRemark(map));
  for (const int frame : map.frames_left_out) {
    remarks.push_back(fmt::format(
        "frame {} is left out of the map: its depth or pose disagrees with its neighbours'",
        dataset.frames[frame].stamp_ns));
  }
  const auto limit = [](const std::optional<double>& asked) {
    return asked ? Report(*asked) : Report(nullptr);
  };
  return {{"map",
           {{"points", map.points},
            {"frames", map.frames - static_cast<int>(map.frames_left_out.size())},
            {"voxel_m", map.voxel_m},
            {"max_sigma_m", limit(map.max_sigma_m)},
            {"max_sigma_pct", limit(map.max_sigma_pct)}}},
          {"mapping", {{"remarks", std::move(remarks)}}}};
}

FusedMap NoMap(const StageContext&, const PosedPart&) { return {}; }

void RequireMemoryForFusion(std::size_t frames, double view_mb, const FusionOptions& options,
                            int allowed_mb) {
  const std::size_t compared = ComparedViews(frames, options);
  const double least_mb =
      kProgramMegabytes + kFusionMegabytes + static_cast<double>(compared) * view_mb;
  if (least_mb <= allowed_mb) return;
  throw UsageError(fmt::format(
      "--memory: expected at least {:.0f} MB, for {} depth maps of {:.0f} MB at once, found {}; "
      "fewer fusion.ahead and fusion.neighbours need less",
      std::ceil(least_mb), compared, view_mb, allowed_mb));
}

FusionStage Fusion() {
  return {.name = "fusion",
          .about = "points on a grid, from depth maps that confirm each other",
          .code = CodeHere(),
          .make = MakeMap,
          .publishes = {"dense.ply"},
          .report = DescribeMap};
}

}  // namespace rigmap
