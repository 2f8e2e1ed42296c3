#include "workflows/part_stages.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "adjustment/level_world.h"
#include "colmap/model_io.h"
#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"
#include "dense/dense_matcher.h"
#include "export/ply.h"
#include "export/trajectory_csv.h"
#include "export/tum.h"
#include "features/extract_features.h"
#include "fusion/depth_fusion.h"
#include "mapping/build_graph.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "workflows/gates.h"
#include "workflows/part_trajectory.h"
#include "workflows/sparse_output.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMinMappedKeyframes = 3;

template <class Options>
std::string OptionsText(Options options) {
  return WriteOptions(options.Fields());
}

void WriteText(const fs::path& path, const std::string& text) {
  WriteFileAtomically(path, [&](std::ostream& stream) { stream << text; });
}

fs::path FramePath(const fs::path& folder, const StereoFrame& frame) {
  return folder / (std::to_string(frame.stamp_ns) + ".bin");
}

float MedianAbsolute(std::vector<float> values) {
  for (float& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Features of a frame as Extract left them.
FrameFeatures LoadFeatures(const fs::path& path, const std::string& key) {
  auto features = ReadArtefact<FrameFeatures>(path, key);
  if (!features) {
    throw DataError(fmt::format("{}: expected the features of a frame, found none", path.string()));
  }
  return std::move(*features);
}

std::vector<Rigid3> KeyframePoses(const Odometry& odometry, const KeyframeGraph& graph) {
  std::vector<Rigid3> poses;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    poses.push_back(odometry[keyframe.frame].world_from_left);
  }
  return poses;
}

// The gauge of the adjustment laid into the world, and a pose for every frame.
AdjustedPart LayInWorld(const Dataset& dataset, const Odometry& odometry,
                        const Adjustment& adjustment) {
  std::vector<Eigen::Vector3d> points;
  for (const AdjustedPoint& point : adjustment.points) points.push_back(point.x);
  std::vector<std::optional<Rigid3>> poses;
  for (const TimedPose& pose : AssembleTrajectory(odometry, adjustment, Rigid3())) {
    poses.push_back(pose.world_from_left);
  }
  const LevelledWorld world = LevelWorld(poses, points, dataset);
  return {adjustment, world.world_from_gauge, world.up_source,
          AssembleTrajectory(odometry, adjustment, world.world_from_gauge)};
}

std::optional<double> Median(const std::vector<std::optional<double>>& values) {
  std::vector<double> known;
  for (const auto& value : values) {
    if (value) known.push_back(*value);
  }
  if (known.empty()) return std::nullopt;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

// Frames whose depth goes into the map: keyframes, and all frames where there are hardly any; none
// that is posed by odometry or prediction with a sigma that the voxels would show.
std::vector<int> DenseFrames(const Trajectory& trajectory, double voxel_m) {
  const auto keyframes = std::count_if(trajectory.begin(), trajectory.end(),
                                       [](const TimedPose& pose) { return pose.keyframe; });
  const bool all = keyframes < static_cast<std::ptrdiff_t>(kMinMappedKeyframes);
  std::vector<int> frames;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const TimedPose& pose = trajectory[i];
    const bool sure =
        pose.source == PoseSource::kAdjusted ||
        (pose.source == PoseSource::kOdometry && pose.sigmas.head<3>().maxCoeff() < voxel_m);
    if (sure && (all || pose.keyframe)) frames.push_back(static_cast<int>(i));
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

Trajectory AtAntenna(const Trajectory& trajectory, const Eigen::Vector3d& antenna_in_left) {
  return MovePoint(trajectory, {Eigen::Quaterniond::Identity(), antenna_in_left});
}

void PublishTrajectory(const Dataset& dataset, const Trajectory& trajectory, const fs::path& out) {
  WriteText(out / "trajectory.tum", WriteTum(trajectory));
  WriteText(out / "trajectory.csv", WriteTrajectoryCsv(trajectory));
  const Eigen::Vector3d midpoint = 0.5 * dataset.rig.right_from_left.Inverse().translation;
  WriteText(out / "trajectory_midpoint.tum", WriteTum(AtAntenna(trajectory, midpoint)));
  if (dataset.rig.antenna_in_left) {
    WriteText(out / "trajectory_antenna.tum",
              WriteTum(AtAntenna(trajectory, *dataset.rig.antenna_in_left)));
  }
}

void PublishSparse(const Dataset& dataset, const AdjustedPart& part, const OutputLayout& layout) {
  const SparseModel model = MakeSparseOutput(dataset, part.adjustment, part.world_from_gauge);
  WriteFolderAtomically(layout.Sparse(),
                        [&](const fs::path& folder) { WriteModel(model, folder); });
  WriteFileAtomically(layout.root / "sparse.ply",
                      [&](std::ostream& stream) { WriteSparsePly(stream, model.points); });
}

void PublishCloud(const PointCloud& cloud, const fs::path& path) {
  WriteFileAtomically(path, [&](std::ostream& stream) {
    PlyWriter writer(stream);
    writer.Write(cloud);
    writer.Finish();
  });
}

// The truth that --truth or the dataset names: a TUM file or a folder with trajectory.tum.
std::optional<fs::path> TruthTrajectory(const PartRequest& request, const Dataset& dataset) {
  if (!request.truth) {
    return dataset.truth_path.empty() ? std::nullopt : std::optional<fs::path>(dataset.truth_path);
  }
  return fs::is_directory(*request.truth) ? *request.truth / "trajectory.tum" : *request.truth;
}

}  // namespace

Dataset PartStages::OpenData(const Dataset& opened) const {
  return run_.Run(Stage<Dataset>{
      .name = "dataset",
      .options = DescribeInputs(opened),
      .make = [&] { return opened; },
      .report = [&](const Dataset& dataset) { summary_.SetDataset(dataset); },
  });
}

FeatureIndex PartStages::Extract(const Dataset& dataset) const {
  const std::string options =
      OptionsText(request_.options.features) + OptionsText(request_.options.masks);
  return run_.Run(Stage<FeatureIndex>{
      .name = "features",
      .options = options,
      .make = [&] { return ExtractAll(dataset, options); },
  });
}

FeatureIndex PartStages::ExtractAll(const Dataset& dataset, const std::string& options) const {
  const FeatureSetup setup =
      MakeFeatureSetup(dataset.rig, request_.options.features, request_.options.masks);
  const std::string rig = DescribeRig(dataset.rig);
  FeatureIndex index;
  index.keys.resize(dataset.frames.size());
  std::vector<std::optional<float>> epipolar(dataset.frames.size());
  Progress progress("features", dataset.frames.size());
  tbb::parallel_for(std::size_t{0}, dataset.frames.size(), [&](std::size_t i) {
    const StereoFrame& frame = dataset.frames[i];
    const fs::path path = FramePath(run_.layout().Features(), frame);
    index.keys[i] = HashText(rig + options + DescribeFrame(frame));
    std::optional<FrameFeatures> features;
    if (run_.MayReuse("features")) features = ReadArtefact<FrameFeatures>(path, index.keys[i]);
    if (!features) {
      features = ExtractFeatures(frame, setup);
      WriteArtefact(path, index.keys[i], *features);
    }
    if (!features->epipolar_errors_px.empty()) {
      epipolar[i] = MedianAbsolute(features->epipolar_errors_px);
    }
    progress.Advance();
  });
  for (const auto& error : epipolar) {
    if (error) index.epipolar_px.push_back(*error);
  }
  return index;
}

Odometry PartStages::Track(const Dataset& dataset, const FeatureIndex& features) const {
  const auto& options = request_.options.odometry;
  const auto make = [&] {
    Progress progress("odometry", dataset.frames.size());
    const auto load = [&](int frame) {
      progress.Set(static_cast<std::size_t>(frame) + 1);
      return LoadFeatures(FramePath(run_.layout().Features(), dataset.frames[frame]),
                          features.keys[frame]);
    };
    return TrackFrames(static_cast<int>(dataset.frames.size()), load, dataset.rig, options);
  };
  const auto report = [&](const Odometry& odometry) {
    summary_.SetKeyframes(static_cast<int>(std::count_if(
        odometry.begin(), odometry.end(), [](const auto& frame) { return frame.keyframe; })));
  };
  return run_.Run(Stage<Odometry>{
      .name = "odometry", .options = OptionsText(options), .make = make, .report = report});
}

Correspondences PartStages::Match(const Dataset& dataset, const FeatureIndex& features,
                                  const Odometry& odometry) const {
  const auto& options = request_.options.matching;
  const auto load = [&](int frame) {
    return LoadFeatures(FramePath(run_.layout().Features(), dataset.frames[frame]),
                        features.keys[frame]);
  };
  return run_.Run(Stage<Correspondences>{
      .name = "matching",
      .options = OptionsText(options),
      .make = [&] { return MatchFrames(odometry, load, dataset.rig, options); },
  });
}

KeyframeGraph PartStages::WriteGraph(const Dataset& dataset, const Odometry& odometry,
                                     const Correspondences& matches) const {
  const auto& options = request_.options.mapping;
  const OutputLayout& layout = run_.layout();
  const auto publish = [&](const KeyframeGraph& graph) {
    LinkImages(dataset, layout.Images());
    WriteDatabase(FindColmap(), MakeDatabaseContent(graph, matches, dataset.rig), layout.Database(),
                  layout.Log("database"));
  };
  return run_.Run(Stage<KeyframeGraph>{
      .name = "database",
      .options = OptionsText(options),
      .make = [&] { return BuildKeyframeGraph(matches, odometry, dataset, options); },
      .publish = publish,
      .published = {layout.Database(), layout.Images()},
  });
}

MappingResult PartStages::Map(const Dataset& dataset, const Odometry& odometry,
                              const Correspondences& matches, const KeyframeGraph& graph) const {
  const auto& options = request_.options.mapping;
  const OutputLayout& layout = run_.layout();
  const auto make = [&] {
    if (graph.keyframes.size() < kMinMappedKeyframes) {
      fs::create_directories(layout.Models());
      return MappingResult{{}, "none", {"fewer than three keyframes: nothing to map"}};
    }
    const GraphWithPoses input{graph, matches, dataset.rig, KeyframePoses(odometry, graph)};
    const MappingPaths paths{layout.Database(), layout.Images(), layout.Models(), layout.Scratch(),
                             layout.Log("mapping")};
    MappingResult mapped = MapKeyframes(FindColmap(), input, paths, options, request_.threads);
    fs::remove_all(layout.Scratch());
    return mapped;
  };
  return run_.Run(Stage<MappingResult>{
      .name = "mapping",
      .options = OptionsText(options),
      .make = make,
      .report = [&](const MappingResult& mapped) { summary_.SetMapping(mapped); },
  });
}

PlacedKeyframes PartStages::Scale(const Dataset& dataset, const Odometry& odometry,
                                  const KeyframeGraph& graph, const MappingResult& models) const {
  const auto& options = request_.options.scale;
  const auto make = [&] {
    return PlaceModels(models.models, KeyframePoses(odometry, graph), dataset.rig, options);
  };
  return run_.Run(Stage<PlacedKeyframes>{
      .name = "scale",
      .options = OptionsText(options),
      .make = make,
      .report = [&](const PlacedKeyframes& placed) { summary_.SetScale(placed); },
  });
}

AdjustedPart PartStages::Adjust(const Dataset& dataset, const FeatureIndex& features,
                                const Odometry& odometry, const Correspondences& matches,
                                const KeyframeGraph& graph, const PlacedKeyframes& placed) const {
  const auto& options = request_.options.adjustment;
  const OutputLayout& layout = run_.layout();
  const auto make = [&] {
    std::vector<std::optional<Rigid3>> mapped(odometry.size());
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      mapped[graph.keyframes[k].frame] = placed.world_from_left[k];
    }
    const Adjustment adjustment =
        AdjustBundle({matches, dataset.rig, StartingPoses(odometry, mapped)}, options);
    return LayInWorld(dataset, odometry, adjustment);
  };
  const auto report = [&](const AdjustedPart& part) {
    summary_.SetTrajectory(part.trajectory, part.world_up);
    const PlacedKeyframes* mapped = placed.models.empty() ? nullptr : &placed;
    summary_.AddGates(
        JudgePart({dataset.rig, odometry, part.adjustment, mapped, features.epipolar_px},
                  request_.options.gates));
  };
  const auto publish = [&](const AdjustedPart& part) {
    PublishTrajectory(dataset, part.trajectory, layout.root);
    PublishSparse(dataset, part, layout);
  };
  return run_.Run(Stage<AdjustedPart>{
      .name = "adjustment",
      .options = OptionsText(options),
      .make = make,
      .report = report,
      .publish = publish,
      .published = {layout.root / "trajectory.tum", layout.root / "trajectory.csv",
                    layout.root / "trajectory_midpoint.tum", layout.Sparse(),
                    layout.root / "sparse.ply"},
  });
}

DepthIndex PartStages::MatchDense(const Dataset& dataset, const AdjustedPart& part) const {
  const std::string options =
      OptionsText(request_.options.dense) + OptionsText(request_.options.masks);
  const auto report = [&](const DepthIndex& index) {
    summary_.AddGates({JudgeDepthBias(index.bias_px, request_.options.gates)});
  };
  return run_.Run(Stage<DepthIndex>{
      .name = "dense",
      // The voxel decides which frames are sure enough.
      .options = options + fmt::format("{}", request_.options.fusion.voxel_m),
      .make = [&] { return MatchAllDense(dataset, part, options); },
      .report = report,
  });
}

DepthIndex PartStages::MatchAllDense(const Dataset& dataset, const AdjustedPart& part,
                                     const std::string& options) const {
  DepthIndex index;
  index.frames = DenseFrames(part.trajectory, request_.options.fusion.voxel_m);
  index.keys.resize(index.frames.size());
  const DenseMatcher matcher(dataset.rig, request_.options.dense, request_.options.masks);
  const auto points = PointsInLeft(part.adjustment);
  const std::string rig = DescribeRig(dataset.rig);
  std::vector<std::optional<double>> biases(index.frames.size());
  Progress progress("dense", index.frames.size());
  tbb::task_arena arena(DenseThreads(dataset.rig, request_));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, index.frames.size(), [&](std::size_t i) {
      const StereoFrame& frame = dataset.frames[index.frames[i]];
      const fs::path path = FramePath(run_.layout().Depths(), frame);
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
  index.bias_px = Median(biases);
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
      posed.push_back({FramePath(run_.layout().Depths(), dataset.frames[frame]), depths.keys[i],
                       part.trajectory[frame].world_from_left});
    }
    // A single frame has nobody to agree with.
    options.min_views = std::min(options.min_views, std::max(1, static_cast<int>(posed.size())));
    const PointCloud cloud = FuseDepthMaps(posed, options);
    PublishCloud(cloud, ply);
    return HashFile(ply);
  };
  // The map itself is the artefact; what is kept beside it is its hash.
  run_.Run(Stage<std::string>{
      .name = "fusion",
      .options = OptionsText(request_.options.fusion),
      .make = make,
      .publish =
          [&](const std::string& hash) {
            if (!fs::exists(ply) || HashFile(ply) != hash) make();
          },
      .published = {ply},
  });
}

void PartStages::Evaluate(const Dataset& dataset, const AdjustedPart& part) const {
  const auto& options = request_.options.evaluation;
  const auto truth = TruthTrajectory(request_, dataset);
  const fs::path json = run_.layout().root / "evaluation.json";
  const auto make = [&]() -> std::string {
    if (!truth) return "";
    std::vector<TumPose> estimate;
    for (const TimedPose& pose : part.trajectory) {
      estimate.push_back({pose.stamp_ns, pose.world_from_left});
    }
    return ToJson(CompareTrajectories(estimate, ReadTum(*truth), options)).dump(1) + "\n";
  };
  const auto publish = [&](const std::string& metrics) {
    if (metrics.empty()) {
      fs::remove(json);
    } else {
      WriteText(json, metrics);
    }
  };
  run_.Run(Stage<std::string>{
      .name = "evaluation",
      .options = OptionsText(options) + HashText(truth ? ReadTextFile(*truth) : ""),
      .make = make,
      .publish = publish,
      .published = {json},
  });
}

}  // namespace rigmap
