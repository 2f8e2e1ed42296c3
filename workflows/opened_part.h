// The folders of parts that are to be joined, read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/tum.h"
#include "workflows/part_folder.h"
#include "workflows/stages/dense.h"
#include "workflows/stages/features.h"
#include "workflows/stages/odometry.h"

namespace rigmap {

// A part's folder, opened.
struct OpenedPart {
  std::filesystem::path root;  // absolute
  std::string name;
  JoinableInput input;
  FeatureIndex features;
  Odometry odometry;
  std::optional<DepthIndex> depths;
  std::string status;
  std::vector<TumPose> trajectory;  // empty: none

  const std::vector<StereoFrame>& Stereo() const { return input.dataset.frames; }
  StampNs FirstStamp() const { return Stereo().front().stamp_ns; }
};

// Throws DataError where a folder holds no part that can be joined or no longer its keypoints, and
// where parts were given different rigs or features made with different options.
std::vector<OpenedPart> OpenAlike(const std::vector<PartFolder>& folders);

// What the whole begins with: the file of all parts or, where their pools differ, none of these.
PooledRig RigFileOfAll(const std::vector<OpenedPart>& parts);

}  // namespace rigmap
