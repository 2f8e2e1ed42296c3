// When the rover's sensors write their rows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/stamp.h"

namespace rigmap {

// Times on the drive: seconds since the first frame.
struct TimeSpan {
  double begin_s = 0.0, end_s = 0.0;

  bool Contains(double time_s) const { return time_s >= begin_s && time_s < end_s; }
};

struct SensorClock {
  StampNs start_stamp_ns = 0;  // of time 0 on the drive
  std::uint64_t seed = 0;      // of all noise

  // To whole milliseconds, as rows are stamped.
  StampNs StampAt(double time_s) const {
    constexpr StampNs kMillisecondNs = 1'000'000;
    const StampNs exact_ns = start_stamp_ns + std::llround(time_s * 1e9);
    return (exact_ns + kMillisecondNs / 2) / kMillisecondNs * kMillisecondNs;
  }
  double TimeAt(StampNs stamp_ns) const {
    return static_cast<double>(stamp_ns - start_stamp_ns) * 1e-9;
  }
};

// The sensors start before the first frame and run on after the drive's end.
inline constexpr double kSensorsBefore_s = 3.7;
inline constexpr double kSensorsAfter_s = 2.0;

// As Katwijk's text files have it: like FormatKatwijkStamp, but a whole second is written as
// millisecond 1000 of the second before ("..._35_1000" is 36.000 s).
std::string FormatKatwijkStampAsRecorded(StampNs stamp_ns);

}  // namespace rigmap
