// Satellite fixes beside the path of the antenna that they were taken with.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "georeference/rtk_alignment.h"

namespace rigmap {

// Metres; `enu` is LocalFrame(alignment.plane_origin).
struct FixPair {
  Eigen::Vector3d antenna_in_world =
      Eigen::Vector3d::Zero();  // at the moment of the fix, by the clocks' offset
  Eigen::Vector3d fix_in_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma_m =
      Eigen::Vector3d::Ones();  // of the fix as stated, at least 1 mm; east, north, up
};

// The RTK fixes during the path in order of time, of those the ones whose plane agrees with it:
// within four sigmas, or four times the scatter of most where that is larger.
std::vector<FixPair> PairFixes(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                               const Eigen::Vector3d& antenna_in_left,
                               const RtkAlignment& alignment,
                               const RtkAlignmentOptions& options = {});

}  // namespace rigmap
