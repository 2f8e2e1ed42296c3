#include "simulation/rover_path.h"

#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

constexpr double kGrid_s = 0.01;

Eigen::Vector2d DirectionOf(double heading_rad) {
  return {std::cos(heading_rad), std::sin(heading_rad)};
}

// From a place on an arc to another: `length_m` along it, while the heading changes.
Eigen::Vector2d AlongArc(double length_m, double from_heading_rad, double to_heading_rad) {
  const double half_rad = 0.5 * (to_heading_rad - from_heading_rad);
  const double chord_per_arc =
      std::abs(half_rad) < 1e-6 ? 1.0 - half_rad * half_rad / 6.0 : std::sin(half_rad) / half_rad;
  return length_m * chord_per_arc * DirectionOf(from_heading_rad + half_rad);
}

}  // namespace

RoverPath::RoverPath(std::span<const PathSegment> segments, double start_heading_rad)
    : start_heading_rad_(start_heading_rad) {
  Knot knot{0.5 * kRamp_s, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  knots_.push_back(knot);
  for (const PathSegment& segment : segments) {
    const Eigen::Vector3d change(segment.length_m, segment.turn_rad, std::abs(segment.length_m));
    knot.time_s += segment.duration_s;
    knot.driven_sum += segment.duration_s * (knot.driven + 0.5 * change);
    knot.driven += change;
    knots_.push_back(knot);
  }
  duration_s_ = knot.time_s + 0.5 * kRamp_s;
  grid_.push_back(Eigen::Vector2d::Zero());
  Eigen::Vector3d last = Driven(0.0);
  for (int i = 1; (i - 1) * kGrid_s < duration_s_; ++i) {
    const Eigen::Vector3d next = Driven(i * kGrid_s);
    grid_.push_back(grid_.back() + AlongArc(next[0] - last[0], start_heading_rad_ + last[1],
                                            start_heading_rad_ + next[1]));
    last = next;
  }
}

const RoverPath::Knot& RoverPath::KnotBefore(double time_s) const {
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                      [](double t, const Knot& knot) { return t < knot.time_s; });
  return after == knots_.begin() ? *after : *(after - 1);
}

Eigen::Vector3d RoverPath::DrivenAbrupt(double time_s) const {
  const Knot& knot = KnotBefore(time_s);
  if (&knot == &knots_.back() || time_s <= knot.time_s) return knot.driven;
  const Knot& next = *(&knot + 1);
  const double share = (time_s - knot.time_s) / (next.time_s - knot.time_s);
  return knot.driven + share * (next.driven - knot.driven);
}

Eigen::Vector3d RoverPath::DrivenSum(double time_s) const {
  const Knot& knot = KnotBefore(time_s);
  const double since_s = time_s - knot.time_s;
  return knot.driven_sum + 0.5 * since_s * (knot.driven + DrivenAbrupt(time_s));
}

// The mean of DrivenAbrupt over kRamp_s: its derivative, the speed, rises and falls in straight
// ramps.
Eigen::Vector3d RoverPath::Driven(double time_s) const {
  return (DrivenSum(time_s + 0.5 * kRamp_s) - DrivenSum(time_s - 0.5 * kRamp_s)) / kRamp_s;
}

PlanarState RoverPath::At(double time_s) const {
  const double clamped_s = std::clamp(time_s, 0.0, duration_s_);
  const auto cell =
      std::min(static_cast<std::size_t>(std::lround(clamped_s / kGrid_s)), grid_.size() - 1);
  const Eigen::Vector3d at_cell = Driven(static_cast<double>(cell) * kGrid_s);
  const Eigen::Vector3d driven = Driven(clamped_s);
  const Eigen::Vector3d rates =
      (DrivenAbrupt(clamped_s + 0.5 * kRamp_s) - DrivenAbrupt(clamped_s - 0.5 * kRamp_s)) / kRamp_s;
  PlanarState state;
  state.heading_rad = start_heading_rad_ + driven[1];
  state.position_m = grid_[cell] + AlongArc(driven[0] - at_cell[0], start_heading_rad_ + at_cell[1],
                                            state.heading_rad);
  state.speed_mps = rates[0];
  state.yaw_rate_radps = rates[1];
  state.travelled_m = driven[2];
  return state;
}

double RoverPath::length_m() const { return knots_.back().driven[2]; }

std::vector<Eigen::Vector2d> RoverPath::Outline(double step_m) const {
  std::vector<Eigen::Vector2d> outline{grid_.front()};
  double since_m = 0.0;
  for (std::size_t i = 1; i < grid_.size(); ++i) {
    const double step = (grid_[i] - grid_[i - 1]).norm();
    if (since_m + step > step_m) {
      outline.push_back(grid_[i - 1]);
      since_m = 0.0;
    }
    since_m += step;
  }
  outline.push_back(grid_.back());
  return outline;
}

}  // namespace rigmap
