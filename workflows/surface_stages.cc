// The stages that make the surface and judge the result.
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/freed_memory.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "dataset/open_dataset.h"
#include "dense/dense_matcher.h"
#include "export/ply.h"
#include "export/tum.h"
#include "fusion/depth_fusion.h"
#include "gates/gates.h"
#include "raster/surface_rasters.h"
#include "raster/surface_views.h"
#include "workflows/compare_result.h"
#include "workflows/part_stages.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// What is kept of the map beside the map itself.
struct FusedMap {
  std::string hash;
  std::uint64_t points = 0;
  std::vector<int> frames_left_out;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(hash, points, frames_left_out);
  }
};

std::optional<double> MedianOfKnown(const std::vector<std::optional<double>>& values) {
  std::vector<double> known;
  for (const auto& value : values) {
    if (value) known.push_back(*value);
  }
  return known.empty() ? std::nullopt : std::optional(Median(std::move(known)));
}

// Frames whose depth goes into the map: keyframes, and all frames where there are hardly any; none
// that is posed by odometry or prediction with a sigma that the voxels would show, none that cannot
// be read.
std::vector<int> DenseFrames(const Trajectory& trajectory, const FeatureIndex& features,
                             double voxel_m) {
  const auto& unreadable = features.unreadable_frames;
  const auto keyframes = std::count_if(trajectory.begin(), trajectory.end(),
                                       [](const TimedPose& pose) { return pose.keyframe; });
  const bool all = keyframes < static_cast<std::ptrdiff_t>(kMinMappedKeyframes);
  std::vector<int> frames;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const TimedPose& pose = trajectory[i];
    const bool sure =
        pose.source == PoseSource::kAdjusted ||
        (pose.source == PoseSource::kOdometry && pose.sigmas.head<3>().maxCoeff() < voxel_m);
    const int frame = static_cast<int>(i);
    if (std::binary_search(unreadable.begin(), unreadable.end(), frame)) continue;
    if (sure && (all || pose.keyframe)) frames.push_back(frame);
  }
  return frames;
}

// Sparse points in each frame's left camera.
std::vector<std::vector<Eigen::Vector3d>> PointsInLeft(const Adjustment& adjustment) {
  std::vector<std::vector<Eigen::Vector3d>> points(adjustment.world_from_left.size());
  for (const AdjustedPoint& point : adjustment.points) {
    for (const PointObservation& o : point.observations) {
      if (o.eye == Eye::kLeft) {
        points[o.frame].push_back(adjustment.world_from_left[o.frame]->Inverse() * point.x);
      }
    }
  }
  return points;
}

// Of the memory for dense matching, what may stay with the process from frame to frame; the rest is
// for one that needs more than those before.
constexpr double kKeptShare = 2.0 / 3.0;

// How many frames may be dense-matched at once (DenseMatcher states what each needs).
int DenseThreads(const StereoRig& rig, const PartRequest& request) {
  const Camera& camera = rig.left.camera;
  const double disparities =
      camera.MeanFocal() * rig.Baseline() / request.options.dense.min_depth_m;
  const double frame_mb = 4e-6 * camera.width * camera.height * disparities;
  return std::clamp(static_cast<int>(request.memory_mb / std::max(frame_mb, 1.0)), 1,
                    request.threads);
}

}  // namespace

DepthIndex PartStages::MatchDense(const Dataset& dataset, const FeatureIndex& features,
                                  const AdjustedPart& part) const {
  const std::string options =
      RIGMAP_VERSION + OptionsText(request_.options.dense) + OptionsText(request_.options.masks);
  const std::vector<int> frames =
      DenseFrames(part.trajectory, features, request_.options.voxel.voxel_m);
  std::vector<fs::path> files;
  for (const int frame : frames) {
    files.push_back(run_.layout().DepthOf(dataset.frames[frame]));
  }
  const auto report = [&](const DepthIndex& index) {
    summary_.AddGates({JudgeDepthBias(index.bias_px, request_.options.gates.dense)});
  };
  return run_.Run(Stage<DepthIndex>{
      .name = "dense",
      // The voxel decides which frames are sure enough.
      .options = options + OptionsText(request_.options.voxel),
      .make = [&] { return MatchAllDense(dataset, features.rig_fixed, part, frames, options); },
      .report = report,
      .published = files,
  });
}

DepthIndex PartStages::MatchAllDense(const Dataset& dataset, const RigFixedCells& rig_fixed,
                                     const AdjustedPart& part, const std::vector<int>& frames,
                                     const std::string& options) const {
  DepthIndex index;
  index.frames = frames;
  index.keys.resize(index.frames.size());
  const Camera& camera = part.adjustment.rig.left.camera;
  const DenseMatcher matcher(part.adjustment.rig, request_.options.dense, request_.options.masks,
                             rig_fixed.Mask(camera.width, camera.height));
  const auto points = PointsInLeft(part.adjustment);
  const std::string views = DescribeRig(part.adjustment.rig) +
                            std::string(rig_fixed.fixed.begin(), rig_fixed.fixed.end());
  std::vector<std::optional<double>> biases(index.frames.size());
  Progress progress("dense", index.frames.size());
  tbb::task_arena arena(DenseThreads(dataset.rig, request_));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, index.frames.size(), [&](std::size_t i) {
      const StereoFrame& frame = dataset.frames[index.frames[i]];
      const fs::path path = run_.layout().DepthOf(frame);
      index.keys[i] = HashText(views + options + DescribeFrame(frame));
      std::optional<DepthMap> depth;
      if (run_.MayReuse("dense")) depth = LoadDepth(path, index.keys[i]);
      if (!depth) {
        depth = matcher.Compute(frame);
        SaveDepth(path, index.keys[i], *depth);
        ReturnFreedMemory(kKeptShare * request_.memory_mb);
      }
      biases[i] = DisparityBiasPx(*depth, points[index.frames[i]]);
      progress.Advance();
    });
  });
  index.bias_px = MedianOfKnown(biases);
  return index;
}

void PartStages::Fuse(const Dataset& dataset, const AdjustedPart& part,
                      const DepthIndex& depths) const {
  FusionOptions options = request_.options.fusion;
  const VoxelOptions& voxel = request_.options.voxel;
  const fs::path root = run_.layout().root, ply = root / "dense.ply";
  const auto make = [&] {
    std::vector<PosedDepth> posed;
    for (std::size_t i = 0; i < depths.frames.size(); ++i) {
      const int frame = depths.frames[i];
      posed.push_back({run_.layout().DepthOf(dataset.frames[frame]), depths.keys[i],
                       part.trajectory[frame].world_from_left});
    }
    // A single frame has nobody to agree with.
    options.min_views = std::min(options.min_views, std::max(1, static_cast<int>(posed.size())));
    FusedMap fused;
    WriteFileAtomically(ply, [&](std::ostream& stream) {
      PlyWriter writer(stream);
      const auto take = [&](std::span<const SurfacePoint> points) { writer.Write(points); };
      for (const std::size_t i :
           FuseDepthMaps(posed, voxel, options, {run_.layout().Scratch() / "tiles", take})) {
        fused.frames_left_out.push_back(depths.frames[i]);
      }
      writer.Finish();
      fused.points = writer.point_count();
    });
    fs::remove_all(run_.layout().Scratch());
    fused.hash = HashFile(ply);
    if (fused.points > 0) {
      const GriddedCloud cloud{ply, voxel.voxel_m};
      WriteSurfaceRasters(cloud, root, request_.options.raster);
      WriteSurfaceViews(cloud, part.trajectory, root, request_.options.pictures);
    }
    return fused;
  };
  const auto report = [&](const FusedMap& fused) {
    for (const int frame : fused.frames_left_out) {
      summary_.AddRemarks({fmt::format(
          "frame {} is left out of the map: its depth or pose disagrees with its neighbours'",
          dataset.frames[frame].stamp_ns)});
    }
  };
  // The map itself is the product; what is kept beside it is its hash.
  run_.Run(Stage<FusedMap>{
      .name = "fusion",
      .options = OptionsText(voxel) + OptionsText(request_.options.fusion) +
                 OptionsText(request_.options.raster) + OptionsText(request_.options.pictures),
      .make = make,
      .report = report,
      .published = run_.layout().PublishedBy("fusion"),
  });
}

void PartStages::Evaluate(const Dataset& dataset, const AdjustedPart& part) const {
  const PartOptions& options = request_.options;
  const std::string& truth = dataset.truth_path;
  const fs::path root = run_.layout().root, json = root / "evaluation.json";
  const auto make = [&]() -> std::string {
    nlohmann::ordered_json metrics;
    if (!truth.empty()) {
      std::vector<TumPose> estimate;
      for (const TimedPose& pose : part.trajectory) {
        estimate.push_back({pose.stamp_ns, pose.world_from_left});
      }
      metrics = CompareWithTruth(estimate, truth, root / "dense.ply", options);
    }
    const auto survey = CompareWithSurvey(part.trajectory, dataset, root / "dense.ply", options);
    if (!survey.is_null()) metrics.update(survey);
    return metrics.is_null() ? "" : metrics.dump(1) + "\n";
  };
  const auto publish = [&](const std::string& metrics) {
    if (metrics.empty()) return;
    WriteFileAtomically(json, [&](std::ostream& stream) { stream << metrics; });
  };
  run_.Run(Stage<std::string>{
      .name = "evaluation",
      .options = OptionsText(options.evaluation) + OptionsText(options.georeference) +
                 OptionsText(options.rocks) + OptionsText(options.rock_survey) +
                 (truth.empty() ? "" : DescribeTruth(truth)) + DescribeSurvey(dataset),
      .make = make,
      .publish = publish,
      .published = !truth.empty() || HasFixes(dataset) ? std::vector<fs::path>{json}
                                                       : std::vector<fs::path>(),
  });
}

}  // namespace rigmap
