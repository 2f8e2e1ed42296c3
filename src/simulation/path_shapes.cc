// The shapes that a RoverPath can have.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "simulation/rover_path.h"

namespace rigmap {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

using Segments = std::vector<PathSegment>;

// How long the way is and how it may be driven.
struct Drive {
  double length_m;
  double speed_mps;
  int intervals;
  double interval_s;

  PathSegment Arc(double arc_m, double turn_rad) const {
    return {arc_m, turn_rad, std::abs(arc_m) / speed_mps};
  }
  PathSegment Straight(double straight_m) const { return Arc(straight_m, 0.0); }
  PathSegment Turn(double radius_m, double turn_rad) const {
    return Arc(radius_m * std::abs(turn_rad), turn_rad);
  }
};

// What is left of a way after length_m; nothing beyond.
Segments CutOff(const Segments& segments, double length_m) {
  Segments kept;
  for (const PathSegment& segment : segments) {
    const double share = std::min(1.0, length_m / segment.length_m);
    if (share <= 0.0) break;
    kept.push_back(
        {share * segment.length_m, share * segment.turn_rad, share * segment.duration_s});
    length_m -= segment.length_m;
  }
  return kept;
}

Segments Straight(const Drive& drive) { return {drive.Straight(drive.length_m)}; }

Segments SCurve(const Drive& drive) {
  const double quarter_m = drive.length_m / 4.0;
  const double turn_rad = std::min(0.6, quarter_m / kSmallestRadius_m);
  return {drive.Arc(quarter_m, turn_rad), drive.Arc(2.0 * quarter_m, -2.0 * turn_rad),
          drive.Arc(quarter_m, turn_rad)};
}

Segments Loop(const Drive& drive) {
  return {drive.Arc(drive.length_m, std::min(2.5 * kPi, drive.length_m / kSmallestRadius_m))};
}

// Three arcs of one radius: the middle one's centre lies on the stem's line since cos 60 = 1/2.
Segments LoopOpposite(const Drive& drive) {
  constexpr double kArcs_rad = 420.0 * kDegree;
  constexpr double kWidest_m = 2.5;  // farther out the stem would be out of sight
  const double radius_m =
      std::clamp(drive.length_m / 2.0 / kArcs_rad, kSmallestRadius_m, kWidest_m);
  const double stem_m = std::max(0.0, 0.5 * (drive.length_m - radius_m * kArcs_rad));
  const Segments whole{drive.Straight(stem_m), drive.Turn(radius_m, -60.0 * kDegree),
                       drive.Turn(radius_m, 300.0 * kDegree), drive.Turn(radius_m, -60.0 * kDegree),
                       drive.Straight(stem_m)};
  return CutOff(whole, drive.length_m);
}

Segments UTurn(const Drive& drive) {
  const double radius_m = std::clamp(drive.length_m / 10.0, kSmallestRadius_m, 2.0);
  const Segments whole{drive.Straight(drive.length_m / 2.0), drive.Turn(radius_m, kPi),
                       drive.Straight(drive.length_m)};
  return CutOff(whole, drive.length_m);
}

Segments StopAndGo(const Drive& drive) {
  const int stops = drive.intervals >= 48 ? 3 : 2;
  const double rest_s = std::min(6.0, drive.intervals / 8.0) * drive.interval_s;
  const double leg_m = (drive.length_m - stops * rest_s * drive.speed_mps) / (stops + 1);
  Segments segments{drive.Straight(leg_m)};
  for (int i = 0; i < stops; ++i) {
    segments.push_back({0.0, 0.0, rest_s});
    segments.push_back(drive.Straight(leg_m));
  }
  return segments;
}

// Metres and degrees. Crosses and joins its own way, comes back along parts of it in either
// direction and has corners as tight as the rover takes them.
constexpr std::array<std::pair<double, double>, 29> kTraverse3{{
    {9.0, -30.0},   {7.0, 0.0},   {1.7, 80.0},   {12.0, 0.0},  {1.7, 85.0},  {9.0, 20.0},
    {14.0, 300.0},  {8.0, 0.0},   {1.6, -75.0},  {10.0, 0.0},  {1.9, 100.0}, {7.0, -25.0},
    {16.0, -360.0}, {6.0, 0.0},   {1.7, 90.0},   {13.0, 0.0},  {6.0, 90.0},  {26.0, 0.0},
    {2.0, -110.0},  {5.0, 0.0},   {6.5, -160.0}, {9.0, 0.0},   {1.8, 95.0},  {12.0, 30.0},
    {12.0, 360.0},  {1.6, -70.0}, {8.0, -20.0},  {1.8, -95.0}, {9.7, 15.0},
}};

Segments Traverse3(const Drive& drive) {
  Segments whole;
  for (const auto& [length_m, turn_deg] : kTraverse3) {
    whole.push_back(drive.Arc(length_m, turn_deg * kDegree));
  }
  return CutOff(whole, drive.length_m);
}

// The rests let the wheels stop before the turn and after it.
Segments SpotTurn(const Drive& drive) {
  const double turning = std::min(15.0, drive.intervals / 2.0);
  const double turning_s = turning * drive.interval_s;
  const PathSegment rest{0.0, 0.0, RoverPath::kRamp_s};
  const double legs_m = drive.length_m - (turning_s + 2.0 * rest.duration_s) * drive.speed_mps;
  const PathSegment leg = drive.Straight(0.5 * legs_m);
  return {leg, rest, {0.0, turning * 6.0 * kDegree, turning_s}, rest, leg};
}

Segments Backwards(const Drive& drive) {
  return {drive.Arc(-drive.length_m, std::min(0.5, drive.length_m / kSmallestRadius_m))};
}

const std::map<std::string, std::function<Segments(const Drive&)>>& Shapes() {
  static const std::map<std::string, std::function<Segments(const Drive&)>> shapes{
      {"straight", Straight},          {"s-curve", SCurve},     {"loop", Loop},
      {"loop-opposite", LoopOpposite}, {"u-turn", UTurn},       {"stop-and-go", StopAndGo},
      {"traverse3", Traverse3},        {"spot-turn", SpotTurn}, {"backwards", Backwards}};
  return shapes;
}

void Validate(const PathRequest& request) {
  if (!Shapes().contains(request.shape)) {
    throw UsageError(fmt::format("path: expected one of {}, found '{}'",
                                 fmt::join(kPathNames, ", "), request.shape));
  }
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (request.intervals < 1 || !positive(request.spacing_m) || !positive(request.interval_s) ||
      !std::isfinite(request.start_heading_rad)) {
    throw UsageError(
        fmt::format("path: expected a positive number of intervals, spacing and interval, found {} "
                    "of {} m and {} s",
                    request.intervals, request.spacing_m, request.interval_s));
  }
  const double duration_s = request.intervals * request.interval_s;
  if (duration_s < 8.0 * RoverPath::kRamp_s) {
    throw UsageError(fmt::format("path: expected at least {} s, found {} intervals of {} s",
                                 8.0 * RoverPath::kRamp_s, request.intervals, request.interval_s));
  }
}

}  // namespace

RoverPath MakeRoverPath(const PathRequest& request) {
  Validate(request);
  const double speed_mps = request.spacing_m / request.interval_s;
  const double driving_s = request.intervals * request.interval_s - RoverPath::kRamp_s;
  const Drive drive{speed_mps * driving_s, speed_mps, request.intervals, request.interval_s};
  if (request.shape == "traverse3" && drive.length_m > kTraverse3_m) {
    throw UsageError(fmt::format("path: expected at most {} m of traverse3, found {:.1f} m",
                                 kTraverse3_m, drive.length_m));
  }
  return RoverPath(Shapes().at(request.shape)(drive), request.start_heading_rad);
}

}  // namespace rigmap
