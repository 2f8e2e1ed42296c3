// What a dataset is, whatever place it lies at: for the keys of what is made from it.
#pragma once

#include <string>
#include <vector>

#include "core/file_hashes.h"
#include "scene/dataset.h"

namespace rigmap {

struct DatasetContent {
  // Changes with any value of the rig, of its pool, or pixel of its masks.
  std::string rig;
  std::vector<std::string> frames;  // each with its stamp and any byte of its images
  // Each with the bytes of its images only, whatever its stamp, folder and name: twelve hexadecimal
  // digits. Empty where both images are the same bytes: such are black or white, in any drive.
  std::vector<std::string> images;
  std::string lone;          // the lone images, each with its stamp, eye and bytes; empty: none
  std::string inclinometer;  // with the readings beside the frames
  std::string sensors;       // with all that wheels and inertial unit measured; empty: nothing

  std::string Key() const;  // of all that
  // Of the frames alone: the same for two results that can be compared or continued.
  std::string FramesKey() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rig, frames, images, lone, inclinometer, sensors);
  }
};

// Reads every image once, unless `hashes` knows it. The truth is left out: no stage before
// evaluation may depend on it. Throws DataError when a file is gone.
DatasetContent HashContent(const Dataset& dataset, FileHashes& hashes);

// Again the hash of the rig alone, after it has changed.
std::string HashRig(const Dataset& dataset, FileHashes& hashes);

// The rig without the files of this machine that it names.
StereoRig WithoutMasks(const StereoRig& rig);
// The values of a rig as text: without its file's name and its masks.
std::string DescribeRig(const StereoRig& rig);

}  // namespace rigmap
