// `rigmap calibrate`: one rig for many parts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigmap {

struct CalibrateRequest {
  std::vector<std::filesystem::path> outs;  // folders that rigmap part has left, of one rig file
  std::filesystem::path rig_out;            // replaced
};

// Writes the rig file that the parts together tell, with what they leave unknown of it and the rig
// without each of them, and returns a table of how each compares with the others. Parts that were
// given a pool count from the rig that it started from; those that were all given the same one and
// are none of its parts add to it. Throws DataError where a folder has no calibration.json, where
// parts began with different rig files or have frames in common, and where none tells anything.
std::string Calibrate(const CalibrateRequest& request);

}  // namespace rigmap
