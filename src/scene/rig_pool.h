// What each part of a pool told of the rig that they have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/calibration.h"
#include "scene/rig.h"

namespace rigmap {

// The rig as all parts of the pool but one tell it.
struct RigWithoutPart {
  std::vector<std::string> frames;                           // of that part: DatasetContent::images
  CalibrationVector correction = CalibrationVector::Zero();  // of RigPool::start
  // Of the rig so corrected; nothing where that is the start and states none.
  std::optional<CalibrationMatrix> covariance;
};

struct RigPool {
  StereoRig start;  // the rig before any of them was seen
  std::vector<RigWithoutPart> parts;
};

// A rig file: the rig, and the pool that it is of, if it is of one.
struct PooledRig {
  StereoRig rig;
  std::optional<RigPool> pool;
};

}  // namespace rigmap
