#include "workflows/part_stages.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "adjustment/level_world.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "dataset/open_dataset.h"
#include "features/extract_features.h"
#include "mapping/build_graph.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "workflows/gates.h"
#include "workflows/part_trajectory.h"
#include "workflows/sparse_output.h"
#include "workflows/trajectory_output.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Features of a frame as Extract left them.
FrameFeatures LoadFeatures(const fs::path& path, const std::string& key) {
  auto features = ReadArtefact<FrameFeatures>(path, key);
  if (!features) {
    throw DataError(
        fmt::format("{}: expected the features of a frame, found a damaged file; run again with "
                    "--from features",
                    path.string()));
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

}  // namespace

void PartStages::TakeUp(const Dataset& dataset) const {
  // The product is the key: what the inputs were is kept for the stages behind, nothing is read.
  run_.Run(Stage<std::string>{
      .name = "dataset",
      .options = DescribeInputs(dataset),
      .make = [&] { return dataset.format; },
      .report = [&](const std::string&) { summary_.SetDataset(dataset); },
  });
}

FeatureIndex PartStages::Extract(const Dataset& dataset) const {
  const std::string options =
      RIGMAP_VERSION + OptionsText(request_.options.features) + OptionsText(request_.options.masks);
  std::vector<fs::path> files;
  for (const StereoFrame& frame : dataset.frames) files.push_back(run_.layout().FeaturesOf(frame));
  return run_.Run(Stage<FeatureIndex>{
      .name = "features",
      .options = options,
      .make = [&] { return ExtractAll(dataset, options); },
      .report =
          [&](const FeatureIndex& index) {
            for (const auto& path : index.unreadable_images) {
              spdlog::warn("{}: cannot be read as an image, its frame shows nothing", path);
            }
            summary_.AddUnreadableImages(index.unreadable_images);
          },
      .published = files,
  });
}

FeatureIndex PartStages::ExtractAll(const Dataset& dataset, const std::string& options) const {
  const FeatureSetup setup =
      MakeFeatureSetup(dataset.rig, request_.options.features, request_.options.masks);
  const std::string rig = DescribeRig(dataset.rig);
  FeatureIndex index;
  index.keys.resize(dataset.frames.size());
  std::vector<std::optional<float>> epipolar(dataset.frames.size());
  std::vector<std::vector<std::string>> unreadable(dataset.frames.size());
  Progress progress("features", dataset.frames.size());
  tbb::parallel_for(std::size_t{0}, dataset.frames.size(), [&](std::size_t i) {
    const StereoFrame& frame = dataset.frames[i];
    const fs::path path = run_.layout().FeaturesOf(frame);
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
    unreadable[i] = std::move(features->unreadable_images);
    progress.Advance();
  });
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    if (epipolar[i]) index.epipolar_px.push_back(*epipolar[i]);
    if (unreadable[i].empty()) continue;
    index.unreadable_frames.push_back(static_cast<int>(i));
    index.unreadable_images.insert(index.unreadable_images.end(), unreadable[i].begin(),
                                   unreadable[i].end());
  }
  return index;
}

Odometry PartStages::Track(const Dataset& dataset, const FeatureIndex& features) const {
  const auto& options = request_.options.odometry;
  const auto make = [&] {
    Progress progress("odometry", dataset.frames.size());
    const auto load = [&](int frame) {
      progress.Set(static_cast<std::size_t>(frame) + 1);
      return LoadFeatures(run_.layout().FeaturesOf(dataset.frames[frame]), features.keys[frame]);
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
    return LoadFeatures(run_.layout().FeaturesOf(dataset.frames[frame]), features.keys[frame]);
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
    WriteDatabase(colmap_, MakeDatabaseContent(graph, matches, dataset.rig), layout.Database(),
                  layout.Log("database"));
  };
  return run_.Run(Stage<KeyframeGraph>{
      .name = "database",
      .options = OptionsText(options) + colmap_.version_text,
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
    MappingResult mapped = MapKeyframes(colmap_, input, paths, options, request_.threads);
    fs::remove_all(layout.Scratch());
    return mapped;
  };
  return run_.Run(Stage<MappingResult>{
      .name = "mapping",
      .options = OptionsText(options),
      .make = make,
      .report = [&](const MappingResult& mapped) { summary_.SetMapping(mapped); },
      .published = {layout.Models()},
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
    WriteSparseOutput(MakeSparseOutput(dataset, part.adjustment, part.world_from_gauge), layout);
    WriteTrajectoryOutput(dataset.rig, part.trajectory, layout.root);
  };
  std::vector<fs::path> published = layout.PublishedBy("adjustment");
  if (!dataset.rig.antenna_in_left) std::erase(published, layout.root / "trajectory_antenna.tum");
  return run_.Run(Stage<AdjustedPart>{
      .name = "adjustment",
      .options = OptionsText(options),
      .make = make,
      .report = report,
      .publish = publish,
      .published = published,
  });
}

}  // namespace rigmap
