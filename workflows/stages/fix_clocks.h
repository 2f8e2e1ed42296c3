// How far the clock of satellite fixes is ahead of the images', part by part.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "georeference/rtk_alignment.h"
#include "pipeline/stage.h"
#include "workflows/stages/adjusted_part.h"
#include "workflows/stages/joined_parts.h"

namespace rigmap {

// Found for each part of a join by its own stretch of the trajectory. Weak where that does not tell
// a clock's offset from a way along the path: fewer than 40 fixes, or turns of less than 90
// degrees.
class FixClocks {
 public:
  FixClocks(const Trajectory& trajectory, const JoinedParts& parts, std::span<const GnssFix> fixes,
            const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options);

  // Seconds, of the part that the moment lies in; `otherwise` where it tells none.
  double OffsetAt(StampNs stamp_ns, double otherwise) const;

  // A list with part, clock_offset_s, sigma_s and weak.
  Report Describe() const;

 private:
  struct Clock {  // of the stretch of the whole that one part was the first to have
    std::string name;
    StampNs first_ns = 0, last_ns = 0;
    RtkFit fit;
    bool weak = true;
  };

  std::vector<Clock> clocks_;
};

}  // namespace rigmap
