// What result folders tell together of one rig, as `rigmap calibrate` takes it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "scene/rig_pool.h"
#include "workflows/stages/calibration_output.h"

namespace rigmap {

struct GivenPart {
  std::string name;
  PartCalibration calibration;
  std::string contradiction;  // in it, as its summary.json says; empty: none
};

struct CalibrationPool {
  StereoRig start;  // before any part was seen; all is told as a correction of it
  StereoRig base;   // what the parts below add to
  std::vector<RigWithoutPart> earlier;  // whose folders are not given, and which base contains
  std::vector<GivenPart> parts;
};

// Of these folders. Throws DataError where one was made with another rig file than the first, where
// two share frames, or where none tells anything.
CalibrationPool ReadPool(const std::vector<std::filesystem::path>& outs);

// That the parts were made with: how far rig files are taken to be off and noise to be shared.
// Throws DataError where they differ.
AdjustmentOptions AdjustmentOptionsOf(const std::vector<std::filesystem::path>& outs);

}  // namespace rigmap
