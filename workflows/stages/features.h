// The stage `features`: each frame's features, in a file of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/dataset_content.h"
#include "features/extract_features.h"
#include "features/feature_store.h"
#include "pipeline/frame_files.h"
#include "pipeline/stage.h"

namespace rigmap {

// Where each frame's features are kept, and what is known of all of them.
struct FeatureIndex {
  std::vector<FrameFile> files;    // of each frame's own features
  std::vector<float> epipolar_px;  // median absolute error per frame that has any
  std::vector<float> near_m;       // NearDepth per frame that has one, by the rig file
  std::vector<int> unreadable_frames;
  std::vector<std::string> unreadable_images;  // of these frames
  RigFixedCells rig_fixed;                     // whose features no stage gets
  std::string how;  // changes with code and options that they were made with

  template <class Archive>
  void serialize(Archive& archive) {
    archive(files, epipolar_px, near_m, unreadable_frames, unreadable_images, rig_fixed, how);
  }
};

using FeaturesStage =
    Stage<FeatureIndex, Takes<Dataset, DatasetContent>, Reads<FeatureOptions, MaskOptions>>;
FeaturesStage Features();
// Throws UsageError where not even one frame of this rig fits into so many megabytes.
void RequireMemoryForFeatures(const StereoRig& rig, int allowed_mb);

// As the stage has left it in a part's folder, files relative to that. Throws DataError
// (joinable.h).
FeatureIndex ReadJoinableFeatures(const std::filesystem::path& root);

// What a part was given. Written by every run, before its stages: where images, fixes and truth lie
// may change, and what they say of the truth, though no stage need be done anew.
struct JoinableInput {
  Dataset dataset;
  DatasetContent content;
  // With its pool: what of a pool is the prior of a part is not what is that of several. Without
  // its own path.
  PooledRig rig_file;
};
void WriteJoinableInput(const std::filesystem::path& root, JoinableInput input);
// Throws DataError as ReadJoinableFeatures.
JoinableInput ReadJoinableInput(const std::filesystem::path& root);

// A view: what the other stages get of them.
FeatureStore OpenFeatures(const StageContext& context, const FeatureIndex& index);

}  // namespace rigmap
