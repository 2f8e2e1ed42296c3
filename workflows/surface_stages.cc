// The stages that make the surface and judge the result.
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "dataset/open_dataset.h"
#include "dense/dense_matcher.h"
#include "export/ply.h"
#include "export/tum.h"
#include "fusion/depth_fusion.h"
#include "workflows/gates.h"
#include "workflows/part_stages.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

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

// How many frames may be dense-matched at once (DenseMatcher states what each needs).
int DenseThreads(const StereoRig& rig, const PartRequest& request) {
  const Camera& camera = rig.left.camera;
  const double disparities =
      camera.MeanFocal() * rig.Baseline() / request.options.dense.min_depth_m;
  const double frame_mb = 4e-6 * camera.width * camera.height * disparities;
  return std::clamp(static_cast<int>(request.memory_mb / std::max(frame_mb, 1.0)), 1,
                    request.threads);
}

void PublishCloud(const PointCloud& cloud, const fs::path& path) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    PlyWriter writer(stream);
    writer.Write(cloud);
    writer.Finish();
  });
}

}  // namespace

DepthIndex PartStages::MatchDense(const Dataset& dataset, const FeatureIndex& features,
                                  const AdjustedPart& part) const {
  const std::string options =
      RIGMAP_VERSION + OptionsText(request_.options.dense) + OptionsText(request_.options.masks);
  const std::vector<int> frames =
      DenseFrames(part.trajectory, features, request_.options.fusion.voxel_m);
  std::vector<fs::path> files;
  for (const int frame : frames) {
    files.push_back(run_.layout().DepthOf(dataset.frames[frame]));
  }
  const auto report = [&](const DepthIndex& index) {
    summary_.AddGates({JudgeDepthBias(index.bias_px, request_.options.gates)});
  };
  return run_.Run(Stage<DepthIndex>{
      .name = "dense",
      // The voxel decides which frames are sure enough.
      .options = options + fmt::format("{}", request_.options.fusion.voxel_m),
      .make = [&] { return MatchAllDense(dataset, part, frames, options); },
      .report = report,
      .published = files,
  });
}

DepthIndex PartStages::MatchAllDense(const Dataset& dataset, const AdjustedPart& part,
                                     const std::vector<int>& frames,
                                     const std::string& options) const {
  DepthIndex index;
  index.frames = frames;
  index.keys.resize(index.frames.size());
  const DenseMatcher matcher(part.adjustment.rig, request_.options.dense, request_.options.masks);
  const auto points = PointsInLeft(part.adjustment);
  const std::string rig = DescribeRig(part.adjustment.rig);
  std::vector<std::optional<double>> biases(index.frames.size());
  Progress progress("dense", index.frames.size());
  tbb::task_arena arena(DenseThreads(dataset.rig, request_));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, index.frames.size(), [&](std::size_t i) {
      const StereoFrame& frame = dataset.frames[index.frames[i]];
      const fs::path path = run_.layout().DepthOf(frame);
      index.keys[i] = HashText(rig + options + DescribeFrame(frame));
      std::optional<DepthMap> depth;
      if (run_.MayReuse("dense")) depth = LoadDepth(path, index.keys[i]);
      if (!depth) {
        depth = matcher.Compute(frame);
        SaveDepth(path, index.keys[i], *depth);
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
  const fs::path ply = run_.layout().root / "dense.ply";
  const auto make = [&] {
    std::vector<PosedDepth> posed;
    for (std::size_t i = 0; i < depths.frames.size(); ++i) {
      const int frame = depths.frames[i];
      posed.push_back({run_.layout().DepthOf(dataset.frames[frame]), depths.keys[i],
                       part.trajectory[frame].world_from_left});
    }
    // A single frame has nobody to agree with.
    options.min_views = std::min(options.min_views, std::max(1, static_cast<int>(posed.size())));
    const PointCloud cloud = FuseDepthMaps(posed, options);
    PublishCloud(cloud, ply);
    return HashFile(ply);
  };
  // The map itself is the product; what is kept beside it is its hash.
  run_.Run(Stage<std::string>{
      .name = "fusion",
      .options = OptionsText(request_.options.fusion),
      .make = make,
      .published = {ply},
  });
}

void PartStages::Evaluate(const Dataset& dataset, const AdjustedPart& part) const {
  const auto& options = request_.options.evaluation;
  const std::string& truth = dataset.truth_path;
  const fs::path json = run_.layout().root / "evaluation.json";
  const auto make = [&]() -> std::string {
    if (truth.empty()) return "";
    std::vector<TumPose> estimate;
    for (const TimedPose& pose : part.trajectory) {
      estimate.push_back({pose.stamp_ns, pose.world_from_left});
    }
    return ToJson(CompareTrajectories(estimate, ReadTum(truth), options)).dump(1) + "\n";
  };
  const auto publish = [&](const std::string& metrics) {
    if (metrics.empty()) return;
    WriteFileAtomically(json, [&](std::ostream& stream) { stream << metrics; });
  };
  run_.Run(Stage<std::string>{
      .name = "evaluation",
      .options = OptionsText(options) + HashText(truth.empty() ? "" : ReadTextFile(truth)),
      .make = make,
      .publish = publish,
      .published = truth.empty() ? std::vector<fs::path>() : std::vector<fs::path>{json},
  });
}

}  // namespace rigmap
