#include "workflows/rig_prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "adjustment/calibration.h"
#include "core/error.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

// The file's own rig, which may have been given masks or an antenna since, with another
// calibration.
StereoRig WithCalibrationOf(const StereoRig& calibrated, const StereoRig& rig) {
  StereoRig result = rig;
  result.left.camera = calibrated.left.camera;
  result.right.camera = calibrated.right.camera;
  result.right_from_left = calibrated.right_from_left;
  result.calibration_covariance = calibrated.calibration_covariance;
  result.stated_sigmas = calibrated.stated_sigmas;
  return result;
}

// As a rig file that states it would be refused.
void RequireRig(const StereoRig& rig, const RigWithoutPart& part) {
  try {
    ParseRigFile(WriteRigFile(rig), "corrected");
  } catch (const DataError& error) {
    throw DataError(
        fmt::format("{}: expected corrections of a pool that leave a rig, found that of the part "
                    "with frame {}: {}",
                    rig.source, part.frames.empty() ? "none" : part.frames.front(), error.what()));
  }
}

}  // namespace

int SharedFrames(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  const std::set<std::string> known(a.begin(), a.end());
  return static_cast<int>(std::ranges::count_if(
      b, [&](const std::string& key) { return !key.empty() && known.contains(key); }));
}

StereoRig RigBeforePool(const PooledRig& file) {
  return file.pool ? WithCalibrationOf(file.pool->start, file.rig) : file.rig;
}

StereoRig RigWithout(const RigPool& pool, const RigWithoutPart& part) {
  StereoRig rig = Corrected(pool.start, part.correction);
  RequireRig(rig, part);
  rig.calibration_covariance = part.covariance;
  return rig;
}

std::optional<PriorWithoutPart> WithoutPart(const PooledRig& file,
                                            const std::vector<std::string>& images) {
  if (!file.pool) return std::nullopt;
  std::vector<const RigWithoutPart*> shared;
  for (const RigWithoutPart& part : file.pool->parts) {
    if (SharedFrames(part.frames, images) > 0) shared.push_back(&part);
  }
  if (shared.empty()) return std::nullopt;
  if (shared.size() == 1) {
    return PriorWithoutPart{WithCalibrationOf(RigWithout(*file.pool, *shared.front()), file.rig),
                            "the rig file contains this part; its prior leaves it out"};
  }
  return PriorWithoutPart{RigBeforePool(file),
                          "the rig file contains several parts with frames of this one; its prior "
                          "is what the file knew before any of them"};
}

}  // namespace rigmap
