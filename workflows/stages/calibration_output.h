// What a part says of its rig's calibration: as calibration.json, so that parts of one rig can be
// put together, and in summary.json.
#pragma once

#include <filesystem>
#include <optional>

#include "dataset/dataset_content.h"
#include "pipeline/stage.h"
#include "scene/adjustment.h"
#include "scene/rig_pool.h"

namespace rigmap {

struct PartCalibration {
  PooledRig given;                  // the rig that its prior was about, and the pool of its file
  std::vector<std::string> frames;  // DatasetContent::images, but for the empty ones
  CalibrationVector correction = CalibrationVector::Zero();
  // At that correction, as sure as they are: correlations counted.
  CalibrationEquations equations;
};

// Writes calibration.json; without equations it says that the part tells nothing of its rig.
void PublishCalibration(const Dataset& dataset, const DatasetContent& content,
                        const Adjustment& adjustment, Publication& publication);

// Of a result folder; nothing where the part tells nothing of its rig. Throws DataError where there
// is no such file, or it cannot be understood.
std::optional<PartCalibration> ReadCalibration(const std::filesystem::path& out);

// For summary.json, how the rig was corrected: the turn of the right eye about its own axes, the
// focal lengths' change, what that moves in the right image; and how well the rig in use is known.
Report DescribeRigChange(const StereoRig& calibrated, const Adjustment& adjustment);

}  // namespace rigmap
