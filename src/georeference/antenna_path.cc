#include "georeference/internal/antenna_path.h"

#include <algorithm>

namespace rigmap {
namespace {

constexpr double kHalfWindow_s = 1.5;

}  // namespace

AntennaPath::AntennaPath(const Trajectory& trajectory, const Eigen::Vector3d& antenna_in_left,
                         double max_gap_s)
    : antenna_in_left_(antenna_in_left), max_gap_s_(max_gap_s) {
  std::ranges::copy_if(trajectory, std::back_inserter(poses_),
                       [](const TimedPose& pose) { return pose.source != PoseSource::kPredicted; });
}

double AntennaPath::SecondsOf(StampNs stamp_ns) const {
  return static_cast<double>(stamp_ns - poses_.front().stamp_ns) * 1e-9;
}

std::optional<Eigen::Vector3d> AntennaPath::PositionAt(double time_s) const {
  const auto after = std::ranges::lower_bound(
      poses_, time_s, {},
      [&](const TimedPose& pose) -> double { return SecondsOf(pose.stamp_ns); });
  if (after == poses_.end()) return std::nullopt;
  const double after_s = SecondsOf(after->stamp_ns);
  if (after_s == time_s) return after->world_from_left * antenna_in_left_;
  if (after == poses_.begin()) return std::nullopt;
  const auto before = after - 1;
  const double before_s = SecondsOf(before->stamp_ns);
  if (after_s - before_s > max_gap_s_) return std::nullopt;
  return Interpolate(before->world_from_left, after->world_from_left,
                     (time_s - before_s) / (after_s - before_s)) *
         antenna_in_left_;
}

std::optional<Eigen::Vector2d> AntennaPath::At(double time_s) const {
  const auto position = PositionAt(time_s);
  return position ? std::optional<Eigen::Vector2d>(position->head<2>()) : std::nullopt;
}

Eigen::Vector2d AntennaPath::VelocityAt(double time_s) const {
  const double last_s = SecondsOf(poses_.back().stamp_ns);
  const auto here = At(time_s);
  double from_s = std::max(time_s - kHalfWindow_s, 0.0);
  double to_s = std::min(time_s + kHalfWindow_s, last_s);
  auto from = At(from_s), to = At(to_s);
  if (!from) from_s = time_s, from = here;
  if (!to) to_s = time_s, to = here;
  if (!from || !to || to_s <= from_s) return Eigen::Vector2d::Zero();
  return (*to - *from) / (to_s - from_s);
}

}  // namespace rigmap
