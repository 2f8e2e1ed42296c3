// Faults on request: what goes wrong on a simulated drive, planned from the words of --fault.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/rig.h"

namespace rigmap {

// Frame indices first <= i < end.
struct FrameRange {
  int first = 0, end = 0;

  bool operator==(const FrameRange&) const = default;
};

// What is wrong with the images of one frame. At most one of dropped, lone, black and truncated.
struct FrameFault {
  bool dropped = false;          // neither image is there
  std::optional<Eye> lone;       // only this eye's image is there
  bool black = false;            // both images are black
  std::optional<Eye> truncated;  // this eye's file ends early
  double exposure_gain = 1.0;    // of both images, 1/1.6 to 1.6
  bool shadow = false;           // the rover's own shadow and a wheel's edge in view
  double glare_area = 0.0;       // share of the image that saturates; 0: no glare

  bool operator==(const FrameFault&) const = default;
};

struct FaultPlan {
  std::vector<FrameFault> frames;  // one per frame
  std::vector<FrameRange> gps_outages, slip_bursts, persons;

  bool operator==(const FaultPlan&) const = default;
};

// `specs` are words NAME=VALUE as DescribeFaultNames lists them; VALUE is a count or a range of
// frame indices FIRST:END. What is counted never touches the first or the last two frames; its
// places are drawn from the seed, each name from numbers of its own, so that asking for one fault
// does not move another (but out of its way: no two of dropped, lone-left, lone-right, black and
// truncated share a frame). A name may be given more than once; where two set the same frame's
// exposure or glare, the later holds.
// Equal arguments give equal plans. Throws UsageError for an unknown name (listing all), a value
// that is neither a count nor a range, a range outside the frames, more than the frames can hold,
// and ranges that contradict each other.
FaultPlan PlanFaults(std::span<const std::string> specs, int frames, std::uint64_t seed,
                     double frame_interval_s);

// One line per name, for --help.
std::string DescribeFaultNames();

}  // namespace rigmap
