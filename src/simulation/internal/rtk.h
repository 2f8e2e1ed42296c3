// What the rover's satellite receiver writes.
#pragma once

#include <iosfwd>
#include <span>
#include <vector>

#include "georeference/local_frame.h"
#include "scene/survey.h"
#include "simulation/rover_motion.h"
#include "simulation/sensor_clock.h"

namespace rigmap {

struct RtkFaults {
  // Stamp of a fix minus the time, by the images' clock, at which the antenna was there.
  double clock_offset_s = 0.0;
  // In the first 40 % of each the fixes are RTK_FLOAT with sigmas of some decimetres, then there
  // are none.
  std::vector<TimeSpan> outages;
};

// A fix every 3 s, give or take a millisecond or two, while the sensors run, with normal noise of
// 4 mm east, 5 mm north and 9 mm up (RTK_FLOAT: 0.18, 0.22 and 0.4 m). `local` tells where on
// Earth the world's origin is.
std::vector<GnssFix> SimulateRtk(const RoverMotion& motion, const RoverMount& mount,
                                 const LocalFrame& local, const SensorClock& clock,
                                 const RtkFaults& faults);

// gps-latlong.txt: stamp, status, latitude and longitude (degrees, in steps of 1e-8 minutes,
// 0.02 mm), altitude (m above the ellipsoid), sigmas north, east, up (m). Katwijk's
// gps-utm31.txt holds the very same rows.
void WriteRtkRows(std::ostream& stream, std::span<const GnssFix> fixes);

}  // namespace rigmap
