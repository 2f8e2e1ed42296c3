#include "georeference/rtk_alignment.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "georeference/internal/antenna_path.h"
#include "georeference/internal/path_fitter.h"
#include "georeference/local_frame.h"

namespace rigmap {
namespace {

constexpr double kMinSigma_m = 0.001;  // a receiver that claims better than that is not believed
constexpr double kMapReach_m = 3.5;    // from the path to the map's edge
constexpr std::size_t kMinFixes = 3, kMinFixesForClock = 4;

double RmsSpeed(const std::vector<PlanePair>& pairs) {
  double sum = 0.0;
  for (const PlanePair& pair : pairs) sum += pair.velocity.squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

// One sigma of a place at the map's edge, to the side of the path.
double EdgeSigma(const PathFit& path_fit) {
  double sum = 0.0;
  for (const PlanePair& pair : path_fit.used) {
    sum += (pair.from - path_fit.world_centre).squaredNorm();
  }
  const double arm_m = std::sqrt(sum / static_cast<double>(path_fit.used.size())) + kMapReach_m;
  return std::sqrt(0.5 * (path_fit.covariance(0, 0) + path_fit.covariance(1, 1)) +
                   arm_m * arm_m * path_fit.covariance(2, 2));
}

bool IsClockDetermined(const PathFit& path_fit, const RtkAlignmentOptions& options) {
  if (!path_fit.determined || path_fit.used.size() < kMinFixesForClock) return false;
  const double sigma_s = std::sqrt(path_fit.covariance(3, 3));
  return std::abs(path_fit.clock_offset_s) <= options.max_clock_offset_s &&
         sigma_s * RmsSpeed(path_fit.used) <= options.max_place_sigma_m &&
         EdgeSigma(path_fit) <= options.max_place_sigma_m;
}

RtkAlignment ToAlignment(const PathFit& path_fit, const Geodetic& origin) {
  RtkAlignment alignment;
  alignment.plane_origin = origin;
  alignment.plane_from_world = path_fit.plane_from_world;
  alignment.clock_offset_s = path_fit.clock_offset_s;
  alignment.used = static_cast<int>(path_fit.used.size());
  alignment.rejected = static_cast<int>(path_fit.outliers);
  alignment.world_centre = path_fit.world_centre;
  alignment.covariance = path_fit.covariance.topLeftCorner<3, 3>();
  double sum = 0.0;
  for (const PlanePair& pair : path_fit.used) {
    sum += (path_fit.plane_from_world * pair.from - pair.to).squaredNorm();
  }
  alignment.rms_residual_m = std::sqrt(sum / static_cast<double>(path_fit.used.size()));
  return alignment;
}

RtkFit FitMotionAndClock(const PathFitter& fitter, const Geodetic& origin,
                         const RtkAlignmentOptions& options, bool is_clock_sought) {
  if (is_clock_sought) {
    const double start_s = fitter.BestOffset(options.max_clock_offset_s, kMinFixesForClock);
    const PathFit path_fit = fitter.Refine(start_s, true);
    if (IsClockDetermined(path_fit, options)) {
      RtkFit fit{ToAlignment(path_fit, origin), ""};
      fit.alignment->clock_offset_sigma_s = std::sqrt(path_fit.covariance(3, 3));
      return fit;
    }
  }
  const PathFit held = fitter.Refine(0.0, false);
  if (held.used.size() < kMinFixes || !held.determined) {
    return {std::nullopt, fmt::format("expected at least {} agreeing RTK fixes along a path, found "
                                      "{}",
                                      kMinFixes, held.used.size())};
  }
  const double sigma_m = EdgeSigma(held);
  if (sigma_m > options.max_place_sigma_m) {
    return {std::nullopt,
            fmt::format("expected RTK fixes that place the map's edge to {} m, found {:.3g} m: too "
                        "few fixes, too short a path, or a path unlike theirs",
                        options.max_place_sigma_m, sigma_m)};
  }
  RtkFit fit{ToAlignment(held, origin), ""};
  if (options.max_clock_offset_s == 0.0) return fit;
  fit.why = "the clock offset of the RTK fixes is not determined by this path and held at 0";
  fit.alignment->unknown_clock_sigma_m = options.unknown_clock_sigma_s * RmsSpeed(held.used);
  return fit;
}

// Most fixes determined it.
bool IsAgreed(const RtkFit& fit) {
  constexpr int kUsedPerRejected = 2;
  return fit.alignment && fit.alignment->used >= kUsedPerRejected * fit.alignment->rejected;
}

// The medians of the coordinates, so that an outlier does no harm; nothing without RTK fixes.
std::optional<Geodetic> MiddleOf(std::span<const GnssFix> fixes) {
  std::vector<double> latitudes_deg, longitudes_deg, altitudes_m;
  for (const GnssFix& fix : fixes) {
    if (fix.status != kRtkFixed) continue;
    latitudes_deg.push_back(fix.latitude_deg);
    longitudes_deg.push_back(fix.longitude_deg);
    altitudes_m.push_back(fix.altitude_m);
  }
  if (latitudes_deg.empty()) return std::nullopt;
  return Geodetic{Median(latitudes_deg), Median(longitudes_deg), Median(altitudes_m)};
}

RtkFit Align(std::span<const GnssFix> fixes, const Trajectory& trajectory,
             const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options,
             bool is_clock_sought) {
  RequireValid(options);
  const AntennaPath path(trajectory, antenna_in_left, options.max_gap_s);
  const auto origin = MiddleOf(fixes);
  if (path.IsEmpty() || !origin) {
    return {std::nullopt, "expected RTK fixes and a path, found none"};
  }
  const LocalFrame plane(*origin);
  std::vector<PlaneFix> fixes_in_plane;
  std::vector<double> others_s;
  for (const GnssFix& fix : fixes) {
    const double time_s = path.SecondsOf(fix.stamp_ns);
    if (fix.status != kRtkFixed) {
      others_s.push_back(time_s);
      continue;
    }
    const Eigen::Vector3d enu = plane.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
    fixes_in_plane.push_back(
        {time_s, enu.head<2>(), fix.sigma_enu_m.head<2>().cwiseMax(kMinSigma_m)});
  }
  RtkFit fit = FitMotionAndClock(PathFitter(path, std::move(fixes_in_plane)), *origin, options,
                                 is_clock_sought);
  if (!fit.alignment) return fit;
  fit.alignment->rejected += static_cast<int>(std::ranges::count_if(others_s, [&](double time_s) {
    return path.At(time_s - fit.alignment->clock_offset_s).has_value();
  }));
  return fit;
}

}  // namespace

OptionFields RtkAlignmentOptions::Fields() {
  return {
      {"max_clock_offset_s", &max_clock_offset_s, "s", AtLeast(0.0).UpTo(60.0),
       "How far the receiver's clock is looked for either way from the images'. 0: taken as "
       "exact."},
      {"max_place_sigma_m", &max_place_sigma_m, "m", MoreThan(0.0),
       "An alignment, or a clock offset, that leaves the edge of the map less certain than this is "
       "not determined. A quarter of a small rock's half width."},
      {"max_gap_s", &max_gap_s, "s", MoreThan(0.0),
       "Poses further apart have nothing between them. About one interval of Katwijk's fixes."},
      {"unknown_clock_sigma_s", &unknown_clock_sigma_s, "s", AtLeast(0.0),
       "Sigma of a clock offset that is not determined. Shown by Katwijk's images: they come "
       "closer to a rock than their fixes by up to about half a second's way."},
  };
}

double RtkAlignment::SigmaAt(const Eigen::Vector2d& x_in_world) const {
  const Eigen::Vector2d arm =
      Eigen::Rotation2Dd(plane_from_world.angle_rad) * (x_in_world - world_centre);
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << Eigen::Matrix2d::Identity(), Eigen::Vector2d(-arm.y(), arm.x());
  const double variance = 0.5 * (jacobian * covariance * jacobian.transpose()).trace();
  return std::sqrt(variance + unknown_clock_sigma_m * unknown_clock_sigma_m);
}

RtkFit AlignToRtk(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                  const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options) {
  return Align(fixes, trajectory, antenna_in_left, options, options.max_clock_offset_s > 0.0);
}

RtkFit AlignToRtkWeakly(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                        const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options,
                        double max_place_sigma_m) {
  RtkFit fit = AlignToRtk(fixes, trajectory, antenna_in_left, options);
  if (fit.alignment) return fit;
  RtkAlignmentOptions less = options;
  less.max_place_sigma_m = std::max(max_place_sigma_m, options.max_place_sigma_m);
  fit.alignment = Align(fixes, trajectory, antenna_in_left, less, false).alignment;
  fit.is_weak = fit.alignment.has_value();
  return fit;
}

std::string FitOnlyExchanged(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                             const Eigen::Vector3d& antenna_in_left,
                             const RtkAlignmentOptions& options) {
  constexpr double kMuchBetter = 3.0, kGoodSigmas = 5.0;  // of residuals
  const RtkFit before = AlignToRtk(fixes, trajectory, antenna_in_left, options);
  std::vector<double> sigmas_m;
  for (const GnssFix& fix : fixes) sigmas_m.push_back(fix.sigma_enu_m.head<2>().norm());
  if (IsAgreed(before) &&
      before.alignment->rms_residual_m <= kGoodSigmas * Median(std::move(sigmas_m))) {
    return {};
  }
  std::vector<GnssFix> exchanged(fixes.begin(), fixes.end());
  for (GnssFix& fix : exchanged) {
    std::swap(fix.latitude_deg, fix.longitude_deg);
    if (std::abs(fix.latitude_deg) > 90.0) return {};
  }
  const RtkFit after = AlignToRtk(exchanged, trajectory, antenna_in_left, options);
  if (!IsAgreed(after)) return {};
  const double after_m = after.alignment->rms_residual_m;
  if (IsAgreed(before) && before.alignment->rms_residual_m < kMuchBetter * after_m) return {};
  return fmt::format(
      "the fixes fit the path, to {:.2g} m, once latitude and longitude are exchanged: are these "
      "columns of their file exchanged?",
      after_m);
}

}  // namespace rigmap
