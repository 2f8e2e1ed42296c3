#include "workflows/plan_remarks.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/stamp_steps.h"
#include "core/statistics.h"
#include "georeference/local_frame.h"

namespace rigmap {
namespace {

// From one fix to the next.
struct FixStep {
  double seconds = 0.0, metres = 0.0;
  double sigma_m = 0.0;  // of the distance, as stated
  StampNs from_ns = 0;
};

std::vector<FixStep> StepsBetween(const std::vector<GnssFix>& fixes) {
  std::vector<FixStep> steps;
  const GnssFix* before = nullptr;
  for (const GnssFix& fix : fixes) {
    if (fix.status != kRtkFixed) continue;
    if (before && fix.stamp_ns > before->stamp_ns) {
      const LocalFrame plane({before->latitude_deg, before->longitude_deg, before->altitude_m});
      const Eigen::Vector3d enu =
          plane.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
      const Eigen::Vector2d sigmas(before->sigma_enu_m.head<2>().norm(),
                                   fix.sigma_enu_m.head<2>().norm());
      steps.push_back({SecondsBetween(before->stamp_ns, fix.stamp_ns), enu.head<2>().norm(),
                       sigmas.norm(), before->stamp_ns});
    }
    before = &fix;
  }
  return steps;
}

}  // namespace

std::vector<std::string> RemarksOnStamps(const std::vector<StampNs>& stamps) {
  constexpr int kUsualOverClose = 5;
  const StampNs usual_ns = StepsOf(stamps).usual_ns;
  int close = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) {
    if (kUsualOverClose * (stamps[i + 1] - stamps[i]) >= usual_ns) continue;
    if (close++ == 0) first = i;
  }
  if (close == 0) return {};
  return {fmt::format(
      "{} of {} pairs are closer to the one before than a fifth of the usual {:.3g} s, the first "
      "of them pair {}, {:.2g} s after: are frames there twice?",
      close, stamps.size(), 1e-9 * static_cast<double>(usual_ns), first + 1,
      SecondsBetween(stamps[first], stamps[first + 1]))};
}

std::vector<std::string> RemarksOnFixes(const std::vector<GnssFix>& fixes) {
  // A rover starts and stops and turns, but does not drive ten times as fast for one fix.
  constexpr double kUsualSpeeds = 10.0, kSigmas = 10.0;
  const std::vector<FixStep> steps = StepsBetween(fixes);
  if (steps.empty()) return {};
  std::vector<double> speeds;
  for (const FixStep& step : steps) speeds.push_back(step.metres / step.seconds);
  const double usual_speed = Median(speeds);
  const auto is_jump = [&](const FixStep& step) {
    return step.metres > kUsualSpeeds * usual_speed * step.seconds + kSigmas * step.sigma_m;
  };
  const auto jump = std::ranges::find_if(steps, is_jump);
  if (jump == steps.end()) return {};
  return {fmt::format(
      "{} of {} steps between RTK fixes are longer than the rover drives, the first of them {:.3g} "
      "m in {:.2g} s, after the fix at {:.3f} s: do fixes jump?",
      std::ranges::count_if(steps, is_jump), steps.size(), jump->metres, jump->seconds,
      1e-9 * static_cast<double>(jump->from_ns))};
}

std::string RemarkOnNeighbours(const PartSpan& earlier, const PartSpan& later, double longest_s) {
  const double pause_s = later.first_s - earlier.last_s;
  if (pause_s <= 0.0) {
    return fmt::format(
        "begins {:.3g} s before part {} ends: parts of one drive follow one another, are these "
        "images there twice?",
        -pause_s, earlier.name);
  }
  if (pause_s <= longest_s) return "";
  return fmt::format("begins {:.3g} s after part {} ends: what lies between has no images", pause_s,
                     earlier.name);
}

}  // namespace rigmap
