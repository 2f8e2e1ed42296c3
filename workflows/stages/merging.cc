#include "workflows/stages/merging.h"

#include "export/ply.h"
#include "fusion/merge_clouds.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

PointCloud InWorld(const FrameCloud& cloud, const Rigid3& world_from_left) {
  PointCloud points;
  for (const CloudPoint& point : cloud) {
    points.push_back(
        {.x_in_world = (world_from_left * point.x_in_left.cast<double>()).cast<float>(),
         .normal = (world_from_left.rotation * point.normal.cast<double>()).cast<float>(),
         .rgb = point.rgb,
         .observations = 1,
         .sigma_m = point.sigma_m});
  }
  return points;
}

FusedMap MakeMerged(const StageContext& context, const Dataset& dataset, const PosedPart& part,
                    const DepthIndex& depths, const CloudOptions& clouds,
                    const MergeOptions& options) {
  const CloudLimits limits = LimitsFor(dataset.rig, depths.near_m, clouds);
  std::vector<std::size_t> posed;  // indices into those with depth
  for (std::size_t i = 0; i < depths.frames.size(); ++i) {
    if (part.trajectory[depths.frames[i]].source != PoseSource::kPredicted) posed.push_back(i);
  }
  FusedMap map{.voxel_m = options.merge_grid_m > 0.0 ? options.merge_grid_m : limits.grid_m};
  const auto cloud_of = [&](std::size_t i) {
    return InWorld(ReadCloud(context, depths.files[posed[i]], limits),
                   part.trajectory[depths.frames[posed[i]]].world_from_left);
  };
  context.publication->File("dense.ply", [&](std::ostream& stream) {
    PlyWriter writer(stream);
    const auto take = [&](std::span<const SurfacePoint> points) { writer.Write(points); };
    MergeClouds(posed.size(), cloud_of, map.voxel_m, {context.scratch / "tiles", take});
    writer.Finish();
    map.points = writer.point_count();
    map.frames = static_cast<int>(posed.size());
  });
  return map;
}

}  // namespace

MergingStage CloudMerging() {
  return {.name = "merging",
          .about = "the clouds of all registered frames, merged on a grid as they lie",
          .code = CodeHere(),
          .make = MakeMerged,
          .publishes = {"dense.ply"},
          .report = DescribeMap};
}

}  // namespace rigmap
