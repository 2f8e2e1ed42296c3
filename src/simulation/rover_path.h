// Where the rover drives on the plane, over time.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace rigmap {

// Driven at constant speed and turning rate: an arc, a straight, a turn on the spot (length 0) or
// a rest (both 0).
struct PathSegment {
  double length_m = 0.0;  // negative: in reverse
  double turn_rad = 0.0;  // of the body, counter-clockwise
  double duration_s = 0.0;
};

struct PlanarState {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // east, north
  double heading_rad = 0.0;                              // counter-clockwise from east, not wrapped
  double speed_mps = 0.0;                                // along the heading; negative in reverse
  double yaw_rate_radps = 0.0;                           // counter-clockwise
  double travelled_m = 0.0;  // along the way, forwards or not; never decreases
};

class RoverPath {
 public:
  // Each change of speed and of turning rate is spread over this time, so that accelerations stay
  // finite; lengths and turns do not change by it.
  static constexpr double kRamp_s = 0.3;

  // Starts at (0, 0) and at rest, kRamp_s / 2 after time 0, and rests for as long before the end.
  RoverPath(std::span<const PathSegment> segments, double start_heading_rad);

  // At any time: before 0 and after duration_s() the rover stands where it starts and ends. Speed
  // and turning rate are continuous. Where one of them is constant against the other the way is an
  // exact arc, elsewhere it is integrated in steps of 10 ms.
  PlanarState At(double time_s) const;
  double duration_s() const { return duration_s_; }
  double length_m() const;

  // Places along the way from start to end, neighbours no farther apart than step_m (at least
  // 1 cm).
  std::vector<Eigen::Vector2d> Outline(double step_m) const;

 private:
  // Where a segment starts, as if speeds could change at once: `*_sum` are integrals over time.
  struct Knot {
    double time_s = 0.0;
    Eigen::Vector3d driven;      // signed metres, radians, unsigned metres
    Eigen::Vector3d driven_sum;  // of `driven` over time since the first knot
  };
  Eigen::Vector3d DrivenAbrupt(double time_s) const;
  Eigen::Vector3d DrivenSum(double time_s) const;
  Eigen::Vector3d Driven(double time_s) const;
  const Knot& KnotBefore(double time_s) const;

  double start_heading_rad_;
  double duration_s_ = 0.0;
  std::vector<Knot> knots_;
  std::vector<Eigen::Vector2d> grid_;  // positions, every 10 ms from time 0
};

// What the command line knows of a path.
struct PathRequest {
  std::string shape = "straight";  // one of kPathNames
  int intervals = 40;              // between frames: one less than there are frames
  double spacing_m = 0.2;          // from frame to frame, at full speed
  double interval_s = 1.25;        // from frame to frame
  double start_heading_rad = 0.0;  // counter-clockwise from east
};

// No curve is tighter than this, but for turns on the spot.
inline constexpr double kSmallestRadius_m = 0.8;
inline constexpr double kTraverse3_m = 221.0;

// With the length l = spacing * (intervals - kRamp_s / interval):
//   straight       l
//   s-curve        left, right, left by 34, 69, 34 degrees; less where a radius would be too small
//   loop           1.25 turns left on a circle, so that its first quarter is driven twice; where
//                  that would be tighter than 0.8 m as much of such a circle as l suffices for (it
//                  closes from l = 5.03 m on)
//   loop-opposite  straight out, round a teardrop of 60, 300 and 60 degrees, back along the stem;
//                  cut off at l (it closes from l = 5.86 m on)
//   u-turn         l / 2 straight, half a circle left of radius l / 10, at least 0.8 m and at most
//                  2 m, and back
//   stop-and-go    straight with two rests of an eighth of the intervals each, at most six; three
//                  rests from 48 intervals on
//   traverse3      221 m with corners and loops, gently curved at first; cut off at l
//   spot-turn      straight, 90 degrees left on the spot at 6 degrees an interval (less with fewer
//                  than 30 intervals: half of them turn), straight
//   backwards      in reverse along a gentle curve (the body turns left by 29 degrees)
inline const std::vector<std::string> kPathNames{"straight",      "s-curve",   "loop",
                                                 "loop-opposite", "u-turn",    "stop-and-go",
                                                 "traverse3",     "spot-turn", "backwards"};

// The path takes intervals * interval_s. Throws UsageError for an unknown shape (naming all),
// spacing, interval or count that are not positive or leave no time to drive, and a traverse3
// longer than it is.
RoverPath MakeRoverPath(const PathRequest& request);

}  // namespace rigmap
