// What a dataset is, whatever place it lies at: for the keys of what is made from it.
#pragma once

#include <string>
#include <vector>

#include "core/file_hashes.h"
#include "scene/dataset.h"

namespace rigmap {

struct DatasetContent {
  std::string rig;                  // changes with any value of the rig or pixel of its masks
  std::vector<std::string> frames;  // each with its stamp and any byte of its images
  std::string inclinometer;         // with the readings beside the frames

  std::string Key() const;  // of all that
  // Of the frames alone: the same for two results that can be compared or continued.
  std::string FramesKey() const;
};

// Reads every image once, unless `hashes` knows it. The truth is left out: no stage before
// evaluation may depend on it. Throws DataError when a file is gone.
DatasetContent HashContent(const Dataset& dataset, FileHashes& hashes);

// The values of a rig as text: without its file's name and its masks.
std::string DescribeRig(const StereoRig& rig);

}  // namespace rigmap
