// The stage `dense`: depth maps of the frames that the map is made of, each in a file.
#pragma once

#include <filesystem>
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
  // Changes with the rig, code and options that they were made with, whatever the frames.
  std::string how;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frames, files, bias_px, voxel_m, view_mb, near_m, how);
  }
};

// The voxel decides which frames are posed well enough to show in it.
using DenseStage = Stage<DepthIndex, Takes<Dataset, DatasetContent, FeatureIndex, PosedPart>,
                         Reads<DenseOptions, MaskOptions, VoxelOptions>>;
DenseStage DenseMatching();

// As the stage has left it in a part's folder; nothing where the part ended before it. Throws
// DataError (joinable.h).
std::optional<DepthIndex> ReadJoinableDepths(const std::filesystem::path& root);

// Depth maps that parts have made, by frames of the data set that joins them.
struct KnownDepths {
  struct Known {
    FrameFile file;   // relative to the output folder of the whole
    std::string how;  // DepthIndex::how

    template <class Archive>
    void serialize(Archive& archive) {
      archive(file, how);
    }
  };
  std::vector<std::optional<Known>> of_frames;

  // Nothing where there is none, or one made in another way.
  std::optional<FrameFile> FileOf(int frame, const std::string& how) const;
};

// The same name where parts are joined.
using JoinedDenseStage =
    Stage<DepthIndex, Takes<Dataset, DatasetContent, FeatureIndex, PosedPart, KnownDepths>,
          Reads<DenseOptions, MaskOptions, VoxelOptions>>;
JoinedDenseStage JoinedDepths();

// The same name for a technique that needs depth before it has poses: of every frame that can be
// read, as near as the stereo matches of its features say.
using FrameDepthStage =
    Stage<DepthIndex, Takes<Dataset, DatasetContent, FeatureIndex, FeatureStore>,
          Reads<DenseOptions, MaskOptions, VoxelOptions>>;
FrameDepthStage FrameDepths();

}  // namespace rigmap
