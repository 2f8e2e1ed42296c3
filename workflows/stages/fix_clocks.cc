#include "workflows/stages/fix_clocks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rigmap {
namespace {

constexpr int kFewestFixes = 40;
constexpr double kLeastTurn_rad = std::numbers::pi / 2.0;

// How far the path turns in all, about up.
double HeadingRange(const Trajectory& trajectory) {
  double heading = 0.0, least = 0.0, most = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Eigen::Vector3d before =
        trajectory[i - 1].world_from_left.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d after = trajectory[i].world_from_left.rotation * Eigen::Vector3d::UnitZ();
    heading += std::atan2(before.x() * after.y() - before.y() * after.x(),
                          before.x() * after.x() + before.y() * after.y());
    least = std::min(least, heading);
    most = std::max(most, heading);
  }
  return most - least;
}

}  // namespace

FixClocks::FixClocks(const Trajectory& trajectory, const JoinedParts& parts,
                     std::span<const GnssFix> fixes, const Eigen::Vector3d& antenna_in_left,
                     const RtkAlignmentOptions& options) {
  for (std::size_t part = 0; part < parts.parts.size(); ++part) {
    Trajectory own;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      if (parts.first_part[i] == static_cast<int>(part)) own.push_back(trajectory[i]);
    }
    if (own.empty()) continue;
    Clock clock{parts.parts[part].name, own.front().stamp_ns, own.back().stamp_ns,
                AlignToRtk(fixes, own, antenna_in_left, options)};
    const auto& alignment = clock.fit.alignment;
    clock.weak = !alignment || !alignment->clock_offset_sigma_s || alignment->used < kFewestFixes ||
                 HeadingRange(own) < kLeastTurn_rad;
    clocks_.push_back(std::move(clock));
  }
}

double FixClocks::OffsetAt(StampNs stamp_ns, double otherwise) const {
  for (const Clock& clock : clocks_) {
    if (!clock.weak && stamp_ns >= clock.first_ns && stamp_ns <= clock.last_ns) {
      return clock.fit.alignment->clock_offset_s;
    }
  }
  return otherwise;
}

Report FixClocks::Describe() const {
  Report list = Report::array();
  for (const Clock& clock : clocks_) {
    const auto& alignment = clock.fit.alignment;
    list.push_back({{"part", clock.name},
                    {"clock_offset_s", alignment ? Report(alignment->clock_offset_s) : Report()},
                    {"sigma_s", alignment && alignment->clock_offset_sigma_s
                                    ? Report(*alignment->clock_offset_sigma_s)
                                    : Report()},
                    {"weak", clock.weak}});
  }
  return list;
}

}  // namespace rigmap
