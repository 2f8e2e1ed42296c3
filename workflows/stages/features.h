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
  std::vector<int> unreadable_frames;
  std::vector<std::string> unreadable_images;  // of these frames
  RigFixedCells rig_fixed;                     // whose features no stage gets
  std::string how;  // changes with code and options that they were made with

  template <class Archive>
  void serialize(Archive& archive) {
    archive(files, epipolar_px, unreadable_frames, unreadable_images, rig_fixed, how);
  }
};

using FeaturesStage =
    Stage<FeatureIndex, Takes<Dataset, DatasetContent>, Reads<FeatureOptions, MaskOptions>>;
FeaturesStage Features();

// The same name where parts are joined: theirs, as they lie.
struct JoinableFrames {
  Dataset dataset;
  StereoRig rig;  // of the dataset, before a pool of parts corrected it
  DatasetContent content;
  FeatureIndex features;  // files relative to the part's folder

  template <class Archive>
  void serialize(Archive& archive) {
    archive(dataset, rig, content, features);
  }
};
// As the stage has left it in a part's folder. Throws DataError (joinable.h).
JoinableFrames ReadJoinableFrames(const std::filesystem::path& root);

// A view: what the other stages get of them.
FeatureStore OpenFeatures(const StageContext& context, const FeatureIndex& index);

}  // namespace rigmap
