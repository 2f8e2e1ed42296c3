// The stage `dense`: each keyframe's depth map, in a file of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset_content.h"
#include "dense/dense_matcher.h"
#include "features/feature_store.h"
#include "pipeline/frame_files.h"
#include "pipeline/stage.h"
#include "scene/voxel_options.h"
#include "workflows/stages/features.h"
#include "workflows/stages/posed_part.h"

namespace rigmap {

struct DepthIndex {
  std::vector<int> frames;
  std::vector<FrameFile> files;  // of each frame's depth map
  std::optional<double> bias_px;
  double voxel_m = 0.0;  // of the map to be made of them
  double view_mb = 0.0;  // what one takes in memory
  double near_m = 0.0;   // distance of near ground

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frames, files, bias_px, voxel_m, view_mb, near_m);
  }
};

// The voxel decides which frames are posed well enough to show in it.
using DenseStage = Stage<DepthIndex, Takes<Dataset, DatasetContent, FeatureIndex, PosedPart>,
                         Reads<DenseOptions, MaskOptions, VoxelOptions>>;
DenseStage DenseMatching();

// The same name for a technique that needs depth before it has poses: of every frame that can be
// read, as near as the stereo matches of its features say.
using FrameDepthStage =
    Stage<DepthIndex, Takes<Dataset, DatasetContent, FeatureIndex, FeatureStore>,
          Reads<DenseOptions, MaskOptions, VoxelOptions>>;
FrameDepthStage FrameDepths();

}  // namespace rigmap
