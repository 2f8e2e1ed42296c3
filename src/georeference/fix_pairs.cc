#include "georeference/fix_pairs.h"

#include <algorithm>

#include "core/statistics.h"
#include "georeference/internal/antenna_path.h"
#include "georeference/local_frame.h"

namespace rigmap {
namespace {

constexpr double kLeastSigma_m = 0.001;  // a receiver that claims better than that is not believed
constexpr double kMostSigmas = 4.0;      // normal noise goes beyond once in 3000 fixes
constexpr double kMedianOfRayleigh = 1.17741;  // median length of a normal vector, in sigmas

double PlaneDistance(const FixPair& pair, const Rigid2& plane_from_world) {
  return NormalisedDistance(plane_from_world,
                            {pair.antenna_in_world.head<2>(), pair.fix_in_enu.head<2>(),
                             pair.sigma_m.head<2>(), Eigen::Vector2d::Zero()});
}

}  // namespace

std::vector<FixPair> PairFixes(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                               const Eigen::Vector3d& antenna_in_left,
                               const RtkAlignment& alignment, const RtkAlignmentOptions& options) {
  std::vector<GnssFix> sorted(fixes.begin(), fixes.end());
  std::ranges::stable_sort(sorted, {}, &GnssFix::stamp_ns);
  const AntennaPath path(trajectory, antenna_in_left, options.max_gap_s);
  const LocalFrame plane(alignment.plane_origin);
  std::vector<FixPair> pairs;
  for (const GnssFix& fix : sorted) {
    if (fix.status != kRtkFixed || path.IsEmpty()) continue;
    const auto antenna = path.PositionAt(path.SecondsOf(fix.stamp_ns) - alignment.clock_offset_s);
    if (!antenna) continue;
    pairs.push_back({*antenna, plane.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m}),
                     fix.sigma_enu_m.cwiseMax(kLeastSigma_m)});
  }
  if (pairs.empty()) return pairs;
  std::vector<double> distances;
  for (const FixPair& pair : pairs) {
    distances.push_back(PlaneDistance(pair, alignment.plane_from_world));
  }
  const double limit = kMostSigmas * std::max(1.0, Median(distances) / kMedianOfRayleigh);
  std::erase_if(pairs, [&](const FixPair& pair) {
    return PlaneDistance(pair, alignment.plane_from_world) > limit;
  });
  return pairs;
}

}  // namespace rigmap
