// Which rig of a pooled file a part begins with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/rig_pool.h"

namespace rigmap {

// What the images of a part have told already must not be its prior. `images` are those of the part
// (DatasetContent::images). The rig of the file with the calibration that all other parts of the
// pool tell, where one of them holds a frame of `images`; that of the pool's start, where several
// do; nothing where none does.
struct PriorWithoutPart {
  StereoRig rig;
  std::string remark;  // what was done, a sentence
};
std::optional<PriorWithoutPart> WithoutPart(const PooledRig& file,
                                            const std::vector<std::string>& images);

// The rig of the file with the calibration that it had before any part of its pool was seen.
StereoRig RigBeforePool(const PooledRig& file);

// The rig as all parts of the pool but this one tell it.
StereoRig RigWithout(const RigPool& pool, const RigWithoutPart& part);

// How many frames two parts have in common; empty keys are those of no frame.
int SharedFrames(const std::vector<std::string>& a, const std::vector<std::string>& b);

}  // namespace rigmap
