// Points as they travel in a report: sorted, delta-coded, in byte planes, deflated, as text.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "report/figures.h"
#include "scene/point_cloud.h"

namespace rigmap {

// One level of detail, n points in Morton order, as zlib's deflate of 18 n bytes in base64:
//   x, y, z   for each the difference of steps from the point before, zigzagged (0, -1, 1, -2 as
//             0, 1, 2, 3) to 32 bits, in four planes of n bytes, the lowest byte first
//   colour    green, red less green, blue less green, each as its difference from the point before
//   sigma     0 unknown, else 1 + 12 log2(sigma / 10 um)
//   observations  16 log2
//   grain     4 log2(grain / finest)
struct PackedLevel {
  std::size_t count = 0;
  std::string text;
};

struct PackedPoints {
  std::array<double, 3> origin_m{};  // world position of step 0
  double step_m = 0.0;
  double finest_m = 0.0;                   // grain of code 0
  std::array<double, 2> height_range_m{};  // world z; the 2nd to the 98th of a hundred
  std::array<int, 2> sigma_range{}, observations_range{};  // codes, the same
  std::array<std::array<double, 3>, 2> bounds_m{};         // corners, of eight of ten points
  std::vector<PackedLevel> levels;  // coarse to fine: a 64th of the points, an 8th, the rest
};

// A step is a tenth of the finest grain, or as small as 21 bits of the extent allow. `finest_m`
// 0: unknown. Of no points: no levels.
PackedPoints PackPoints(const PointCloud& points, double finest_m);

// Without the levels' texts: id and count of each. `count_in_map`: of which these are a share.
Json DescribePoints(const PackedPoints& packed, std::uint64_t count_in_map);

}  // namespace rigmap
