// The stages of a part: what each takes, makes, keeps and publishes.
#pragma once

#include <string>
#include <vector>

#include "colmap/installation.h"
#include "features/rig_fixed.h"
#include "scene/correspondences.h"
#include "scene/dataset.h"
#include "scene/keyframe_graph.h"
#include "scene/mapping_result.h"
#include "scene/odometry.h"
#include "scene/placed_keyframes.h"
#include "scene/trajectory.h"
#include "workflows/adjust_part.h"
#include "workflows/part_request.h"
#include "workflows/part_summary.h"
#include "workflows/stage_runner.h"

namespace rigmap {

// Fewer keyframes than this are not mapped: the odometric poses are all there is.
inline constexpr std::size_t kMinMappedKeyframes = 3;

// Where each frame's features are kept, and what is known of all of them.
struct FeatureIndex {
  std::vector<std::string> keys;   // of each frame's own artefact
  std::vector<float> epipolar_px;  // median absolute error per frame that has any
  std::vector<int> unreadable_frames;
  std::vector<std::string> unreadable_images;  // of these frames
  RigFixedCells rig_fixed;                     // whose features no stage gets

  template <class Archive>
  void serialize(Archive& archive) {
    archive(keys, epipolar_px, unreadable_frames, unreadable_images, rig_fixed);
  }
};

struct DepthIndex {
  std::vector<int> frames;
  std::vector<std::string> keys;  // of each frame's depth map
  std::optional<double> bias_px;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frames, keys, bias_px);
  }
};

class PartStages {
 public:
  // All but `colmap`, which may be empty if the stages that need it are not run, must outlive this.
  PartStages(const PartRequest& request, ColmapInstallation colmap, StageRunner& run,
             PartSummary& summary)
      : request_(request), colmap_(std::move(colmap)), run_(run), summary_(summary) {}

  // Takes up the input: all stages after this one are done anew when it changes.
  void TakeUp(const Dataset& dataset) const;
  // Each frame's features in a file of its own.
  FeatureIndex Extract(const Dataset& dataset) const;
  Odometry Track(const Dataset& dataset, const FeatureIndex& features) const;
  Correspondences Match(const Dataset& dataset, const FeatureIndex& features,
                        const Odometry& odometry) const;
  // Leaves colmap/database.db and colmap/images.
  KeyframeGraph WriteGraph(const Dataset& dataset, const Odometry& odometry,
                           const Correspondences& matches) const;
  // Leaves colmap/models. Nothing is mapped with fewer than three keyframes.
  MappingResult Map(const Dataset& dataset, const Odometry& odometry,
                    const Correspondences& matches, const KeyframeGraph& graph) const;
  PlacedKeyframes Scale(const Dataset& dataset, const Odometry& odometry,
                        const KeyframeGraph& graph, const MappingResult& models) const;
  // Leaves trajectories, sparse/ and sparse.ply.
  AdjustedPart Adjust(const Dataset& dataset, const FeatureIndex& features,
                      const Odometry& odometry, const Correspondences& matches,
                      const KeyframeGraph& graph, const PlacedKeyframes& placed) const;
  DepthIndex MatchDense(const Dataset& dataset, const FeatureIndex& features,
                        const AdjustedPart& part) const;
  // Leaves dense.ply, and, if it has any point, height.tif, ortho.tif and view_*.png.
  void Fuse(const Dataset& dataset, const AdjustedPart& part, const DepthIndex& depths) const;
  // Leaves evaluation.json where there is a truth or there are satellite fixes.
  void Evaluate(const Dataset& dataset, const AdjustedPart& part) const;

 private:
  FrameFeatures LoadFeatures(const Dataset& dataset, const FeatureIndex& index, int frame) const;
  FeatureIndex ExtractAll(const Dataset& dataset, const std::string& options) const;
  DepthIndex MatchAllDense(const Dataset& dataset, const RigFixedCells& rig_fixed,
                           const AdjustedPart& part, const std::vector<int>& frames,
                           const std::string& options) const;

  const PartRequest& request_;
  ColmapInstallation colmap_;
  StageRunner& run_;
  PartSummary& summary_;
};

}  // namespace rigmap
