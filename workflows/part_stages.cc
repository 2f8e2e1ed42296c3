#include "workflows/part_stages.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "dataset/open_dataset.h"
#include "features/extract_features.h"
#include "gates/gates.h"
#include "mapping/build_graph.h"
#include "matching/match_frames.h"
#include "odometry/track_frames.h"
#include "scale/baseline_scale.h"
#include "workflows/map_part.h"
#include "workflows/sparse_output.h"
#include "workflows/trajectory_output.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::vector<Rigid3> KeyframePoses(const Odometry& odometry, const KeyframeGraph& graph) {
  std::vector<Rigid3> poses;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    poses.push_back(odometry[keyframe.frame].world_from_left);
  }
  return poses;
}

}  // namespace

void PartStages::TakeUp(const Dataset& dataset) const {
  // The product is the key: what the inputs were is kept for the stages behind, nothing is read.
  run_.Run(Stage<std::string>{
      .name = "dataset",
      .options = DescribeInputs(dataset),
      .make = [&] { return std::string(Name(dataset.format)); },
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
  index.rig_fixed = FindRigFixed(
      static_cast<int>(dataset.frames.size()),
      [&](int frame) { return LoadFeatures(dataset, index, frame); }, dataset.rig.left.camera);
  return index;
}

// Features of a frame as Extract left them, those that belong to the rig taken away.
FrameFeatures PartStages::LoadFeatures(const Dataset& dataset, const FeatureIndex& index,
                                       int frame) const {
  const fs::path path = run_.layout().FeaturesOf(dataset.frames[frame]);
  auto features = ReadArtefact<FrameFeatures>(path, index.keys[frame]);
  if (!features) {
    throw DataError(
        fmt::format("{}: expected the features of a frame, found a damaged file; run again with "
                    "--from features",
                    path.string()));
  }
  index.rig_fixed.RemoveFrom(*features);
  return std::move(*features);
}

Odometry PartStages::Track(const Dataset& dataset, const FeatureIndex& features) const {
  const auto& options = request_.options.odometry;
  const auto make = [&] {
    Progress progress("odometry", dataset.frames.size());
    const auto load = [&](int frame) {
      progress.Set(static_cast<std::size_t>(frame) + 1);
      return LoadFeatures(dataset, features, frame);
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
  const auto load = [&](int frame) { return LoadFeatures(dataset, features, frame); };
  return run_.Run(Stage<Correspondences>{
      .name = "matching",
      .options = OptionsText(options),
      .make = [&] { return MatchFrames(odometry, load, dataset.rig, options); },
      .report = [&](const Correspondences& found) { summary_.SetRevisits(found.revisits); },
  });
}

KeyframeGraph PartStages::WriteGraph(const Dataset& dataset, const Odometry& odometry,
                                     const Correspondences& matches) const {
  const auto& options = request_.options.keyframe_graph;
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
  const PartOptions& options = request_.options;
  const OutputLayout& layout = run_.layout();
  const auto make = [&] {
    if (graph.keyframes.size() < kMinMappedKeyframes) {
      fs::create_directories(layout.Models());
      return MappingResult{{}, std::nullopt, {"fewer than three keyframes: nothing to map"}};
    }
    const GraphWithPoses input{graph, matches, dataset.rig, KeyframePoses(odometry, graph)};
    const MappingPaths paths{layout.Database(), layout.Images(), layout.Models(), layout.Scratch(),
                             layout.Log("mapping")};
    MappingResult mapped = MapPart(colmap_, input, paths, options, request_.threads);
    fs::remove_all(layout.Scratch());
    return mapped;
  };
  return run_.Run(Stage<MappingResult>{
      .name = "mapping",
      .options = OptionsText(options.mapping) + OptionsText(options.matching.verification) +
                 OptionsText(options.scale) + OptionsText(options.gates.mapping),
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
  const PartOptions& options = request_.options;
  const OutputLayout& layout = run_.layout();
  const auto make = [&] {
    std::vector<std::optional<Rigid3>> mapped(odometry.size());
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      mapped[graph.keyframes[k].frame] = placed.world_from_left[k];
    }
    const auto load = [&](int frame) { return LoadFeatures(dataset, features, frame); };
    return AdjustPart({dataset, matches, odometry, std::move(mapped), load, options});
  };
  const auto report = [&](const AdjustedPart& part) {
    summary_.SetTrajectory(part.trajectory, part.world_up);
    summary_.SetRig(dataset.rig, part.adjustment.rig);
    summary_.AddRemarks(part.remarks);
    const bool was_mapped = graph.keyframes.size() >= kMinMappedKeyframes;
    const PlacedKeyframes* mapped = was_mapped ? &placed : nullptr;
    summary_.AddGates(JudgePart({dataset.rig, part.odometry, part.adjustment, part.trajectory,
                                 mapped, features.epipolar_px},
                                options.gates));
  };
  const auto publish = [&](const AdjustedPart& part) {
    WriteSparseOutput(MakeSparseOutput(dataset, part.adjustment, part.world_from_gauge), layout);
    WriteTrajectoryOutput(part.adjustment.rig, part.trajectory, layout.root);
    if (part.adjustment.IsRigCorrected()) {
      WriteRigOutput(part.adjustment.rig, layout.RefinedRig());
    }
  };
  std::vector<fs::path> published = layout.PublishedBy("adjustment");
  std::erase(published, layout.RefinedRig());  // which only a corrected rig leaves
  if (!dataset.rig.antenna_in_left) std::erase(published, layout.root / "trajectory_antenna.tum");
  return run_.Run(Stage<AdjustedPart>{
      .name = "adjustment",
      .options = OptionsText(options.adjustment) + OptionsText(options.odometry) +
                 OptionsText(options.gates.adjustment),
      .make = make,
      .report = report,
      .publish = publish,
      .published = published,
  });
}

}  // namespace rigmap
