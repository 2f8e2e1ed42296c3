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

// Writes the rig file that the parts together tell, with what they leave unknown of it, and returns
// a table of how each compares with the others. Throws DataError where a folder has no
// calibration.json, where parts were made with different rig files, and where none tells anything.
std::string Calibrate(const CalibrateRequest& request);

}  // namespace rigmap
