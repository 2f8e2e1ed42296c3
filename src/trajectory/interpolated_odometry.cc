#include "trajectory/interpolated_odometry.h"

#include <limits>

namespace rigmap {

namespace {

// Index of the nearest known pose from `from` on, in steps of `direction`.
std::optional<int> NextKnown(const std::vector<std::optional<Rigid3>>& poses, int from,
                             int direction) {
  const int count = static_cast<int>(poses.size());
  for (int i = from; i >= 0 && i < count; i += direction) {
    if (poses[i]) return i;
  }
  return std::nullopt;
}

}  // namespace

Odometry InterpolatedOdometry(const std::vector<StampNs>& stamps_ns,
                              const std::vector<std::optional<Rigid3>>& world_from_left) {
  const int count = static_cast<int>(stamps_ns.size());
  const int first = NextKnown(world_from_left, 0, 1).value();
  Odometry odometry;
  for (int i = 0; i < count; ++i) {
    OdometryFrame& frame = odometry.emplace_back();
    frame.stamp_ns = stamps_ns[i];
    frame.keyframe = true;
    frame.reference = i > first ? i - 1 : i < first ? i + 1 : i;
    if (i != first) frame.step_covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
    const auto before = NextKnown(world_from_left, i, -1);
    const auto after = NextKnown(world_from_left, i, 1);
    const int from = before.value_or(first), to = after.value_or(from);
    frame.world_from_left = *world_from_left[from];
    if (from == to) continue;
    const double share = static_cast<double>(stamps_ns[i] - stamps_ns[from]) /
                         static_cast<double>(stamps_ns[to] - stamps_ns[from]);
    frame.world_from_left = Interpolate(*world_from_left[from], *world_from_left[to], share);
  }
  return odometry;
}

}  // namespace rigmap
