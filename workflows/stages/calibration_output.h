// What a part says of its rig's calibration, as calibration.json, so that parts of one rig can be
// put together.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/stage.h"
#include "scene/adjustment.h"

namespace rigmap {

struct PartCalibration {
  StereoRig rig;  // as its file gave it
  CalibrationVector correction = CalibrationVector::Zero();
  // At that correction, as sure as they are: correlations counted.
  CalibrationEquations equations;
};

// Writes calibration.json; without equations it says that the part tells nothing of its rig.
void PublishCalibration(const StereoRig& given, const Adjustment& adjustment,
                        Publication& publication);

// Of a result folder; nothing where the part tells nothing of its rig. Throws DataError where there
// is no such file, or it cannot be understood.
std::optional<PartCalibration> ReadCalibration(const std::filesystem::path& out);

}  // namespace rigmap
