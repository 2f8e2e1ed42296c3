#include "georeference/earth_fit.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "georeference/internal/height_fit.h"

namespace rigmap {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMinHeightSigma_m = 0.001;  // a receiver that claims better is not believed
constexpr double kFromPathToEdge_m = 3.5;
constexpr double kMaxResiduals = 4.0;
// Twice what a motion takes: with fewer no majority outvotes a bad fix.
constexpr int kFewFixes = 6;
constexpr double kSureSigmas = 3.0;

// How far the fixes of one moment lie above the path, of those that the horizontal fit agrees with.
std::vector<HeightPair> PairHeights(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                                    const Eigen::Vector3d& antenna_in_left,
                                    const RtkAlignment& alignment, double max_gap_s) {
  const LocalFrame plane(alignment.plane_origin);
  const auto offset_ns = static_cast<StampNs>(std::llround(alignment.clock_offset_s * 1e9));
  std::vector<HeightPair> pairs;
  for (const GnssFix& fix : fixes) {
    if (fix.status != kRtkFixed) continue;
    const StampNs stamp_ns = fix.stamp_ns - offset_ns;
    const auto after = std::ranges::lower_bound(trajectory, stamp_ns, {}, &TimedPose::stamp_ns);
    if (after == trajectory.end() || after == trajectory.begin()) continue;
    const TimedPose &from = *(after - 1), &to = *after;
    const double gap_s = 1e-9 * static_cast<double>(to.stamp_ns - from.stamp_ns);
    const bool guessed =
        from.source == PoseSource::kPredicted || to.source == PoseSource::kPredicted;
    if (gap_s > max_gap_s || guessed) continue;
    const double share = 1e-9 * static_cast<double>(stamp_ns - from.stamp_ns) / gap_s;
    const Eigen::Vector3d antenna =
        Interpolate(from.world_from_left, to.world_from_left, share) * antenna_in_left;
    const Eigen::Vector3d enu = plane.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
    const double off_m = (alignment.plane_from_world * antenna.head<2>() - enu.head<2>()).norm();
    if (off_m > kMaxResiduals * std::max(alignment.rms_residual_m, fix.sigma_enu_m.x())) continue;
    pairs.push_back({antenna.head<2>(), enu.z() - antenna.z(),
                     std::max(fix.sigma_enu_m.z(), kMinHeightSigma_m)});
  }
  return pairs;
}

double EdgeSigma(const RtkAlignment& alignment, const Trajectory& trajectory) {
  double sigma_m = 0.0;
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector2d arm = pose.world_from_left.translation.head<2>() - alignment.world_centre;
    const Eigen::Vector2d outwards = arm.norm() > 0.0 ? arm.normalized() : Eigen::Vector2d::UnitX();
    sigma_m = std::max(
        sigma_m, alignment.SigmaAt(alignment.world_centre + arm + kFromPathToEdge_m * outwards));
  }
  return sigma_m;
}

void JudgeTilt(const std::optional<TiltCheck>& check, const char* name, double max_sigma_m,
               std::vector<std::string>& weaknesses) {
  const double limit_rad = std::atan(max_sigma_m / kFromPathToEdge_m);
  if (!check || !(check->sigma_rad <= limit_rad)) {
    weaknesses.push_back(fmt::format(
        "the fixes leave the {} open{}: it is as good as the world's own up", name,
        check ? fmt::format(" (they tell it to {:.2g} degrees)", kDegrees * check->sigma_rad)
              : std::string()));
  } else if (std::abs(check->angle_rad) > std::max(limit_rad, kSureSigmas * check->sigma_rad)) {
    weaknesses.push_back(fmt::format(
        "the fixes contradict the world's up in the {} by {:.2f} degrees, with a sigma of {:.2g}",
        name, kDegrees * check->angle_rad, kDegrees * check->sigma_rad));
  }
}

void Judge(EarthFit& fit, const RtkFit& rtk, const RtkAlignmentOptions& alignment) {
  auto& weaknesses = fit.weaknesses;
  if (!rtk.why.empty()) weaknesses.push_back(rtk.why);
  if (rtk.alignment->used < kFewFixes) {
    weaknesses.push_back(
        fmt::format("only {} fixes agree with the path: a bad one among them would not be noticed",
                    rtk.alignment->used));
  }
  if (fit.edge_sigma_m > alignment.max_place_sigma_m) {
    weaknesses.push_back(
        fmt::format("the edge of the map is known to {:.2g} m only: the path is short, or its "
                    "fixes are few",
                    fit.edge_sigma_m));
  }
  JudgeTilt(fit.along_path, "pitch along the path", alignment.max_place_sigma_m, weaknesses);
  JudgeTilt(fit.across_path, "roll about the path", alignment.max_place_sigma_m, weaknesses);
}

nlohmann::ordered_json ToJson(const std::optional<TiltCheck>& check) {
  if (!check) return nullptr;
  return {{"degrees", kDegrees * check->angle_rad}, {"sigma_degrees", kDegrees * check->sigma_rad}};
}

nlohmann::ordered_json Rows(const Eigen::MatrixXd& matrix) {
  auto rows = nlohmann::ordered_json::array();
  for (const auto& row : matrix.rowwise())
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

nlohmann::ordered_json FrameJson(const EarthFrame& frame) {
  Eigen::Matrix4d enu_from_world = Eigen::Matrix4d::Identity();
  enu_from_world.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(frame.angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  enu_from_world.topRightCorner<3, 1>() = frame.translation;
  const GridFrame grid = EarthMap(frame).GridAround(Eigen::Vector2d::Zero());
  Eigen::Matrix4d utm_from_world = Eigen::Matrix4d::Identity();
  utm_from_world.topLeftCorner<2, 2>() = grid.grid_from_world.linear();
  utm_from_world.topRightCorner<2, 1>() = grid.grid_from_world.translation();
  utm_from_world(2, 3) = grid.GridFromWorld(Eigen::Vector3d::Zero()).z();
  return {{"epsg", frame.zone.Epsg()},
          {"utm_zone", frame.zone.Name()},
          {"heights", "above the WGS84 ellipsoid, metres"},
          {"enu_origin",
           {{"latitude_deg", frame.origin.latitude_deg},
            {"longitude_deg", frame.origin.longitude_deg},
            {"altitude_m", frame.origin.altitude_m}}},
          {"enu_from_world", Rows(enu_from_world)},
          {"utm_from_world", Rows(utm_from_world)}};
}

}  // namespace

OptionFields EarthFitOptions::Fields() {
  return {
      {"max_map_sigma_m", &max_map_sigma_m, "m", MoreThan(0.0),
       "A map whose edge the fixes leave less certain than this gets no coordinates of the Earth. "
       "Beyond a metre a receiver without corrections would do as well. What is weaker than "
       "max_place_sigma_m is used and named."},
  };
}

EarthFit FitToEarth(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                    const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& alignment,
                    const EarthFitOptions& options) {
  RequireValid(options);
  EarthFit fit;
  const RtkFit rtk =
      AlignToRtkWeakly(fixes, trajectory, antenna_in_left, alignment, options.max_map_sigma_m);
  // Elsewhere on Earth they may fit well enough to be believed.
  const std::string exchanged = FitOnlyExchanged(fixes, trajectory, antenna_in_left, alignment);
  if (!exchanged.empty()) return {.frame = {}, .why = exchanged};
  if (!rtk.alignment) return {.frame = {}, .why = rtk.why};
  const Geodetic& origin = rtk.alignment->plane_origin;
  if (!HasUtmZone(origin)) {
    return {.frame = {},
            .why = fmt::format("expected a latitude from -80 to 84 degrees for UTM, found {:.2f}",
                               origin.latitude_deg)};
  }
  const auto pairs =
      PairHeights(fixes, trajectory, antenna_in_left, *rtk.alignment, alignment.max_gap_s);
  if (pairs.empty())
    return {.frame = {}, .why = "expected fixes that agree with the path, found none"};
  const HeightFit height = FitHeight(pairs);
  fit.horizontal = rtk.alignment;
  fit.heights = static_cast<int>(height.used.size());
  fit.height_sigma_m = height.sigma_m;
  fit.height_rms_m = height.rms_m;
  fit.along_path = height.along;
  fit.across_path = height.across;
  fit.edge_sigma_m = EdgeSigma(*rtk.alignment, trajectory);
  fit.heading_sigma_rad = std::sqrt(rtk.alignment->covariance(2, 2));
  const Rigid2& motion = rtk.alignment->plane_from_world;
  fit.frame = EarthFrame{origin,
                         motion.angle_rad,
                         {motion.translation.x(), motion.translation.y(), height.rise_m},
                         UtmZoneOf(origin)};
  Judge(fit, rtk, alignment);
  return fit;
}

nlohmann::ordered_json ToJson(const EarthFit& fit) {
  if (!fit.frame) return {{"epsg", nullptr}, {"why", fit.why}};
  const RtkAlignment& horizontal = *fit.horizontal;
  nlohmann::ordered_json json = FrameJson(*fit.frame);
  const auto& centre = horizontal.world_centre;
  json["sigma"] = {{"horizontal_m", horizontal.SigmaAt(centre)},
                   {"edge_m", fit.edge_sigma_m},
                   {"height_m", fit.height_sigma_m},
                   {"heading_deg", kDegrees * fit.heading_sigma_rad}};
  json["fixes"] = {
      {"used", horizontal.used},          {"rejected", horizontal.rejected},
      {"heights", fit.heights},           {"horizontal_rms_m", horizontal.rms_residual_m},
      {"height_rms_m", fit.height_rms_m}, {"clock_offset_s", horizontal.clock_offset_s},
      {"clock_offset_sigma_s", nullptr}};
  if (horizontal.clock_offset_sigma_s) {
    json["fixes"]["clock_offset_sigma_s"] = *horizontal.clock_offset_sigma_s;
  }
  json["tilt_by_fixes"] = {{"along_path", ToJson(fit.along_path)},
                           {"across_path", ToJson(fit.across_path)}};
  json["weak"] = fit.weaknesses;
  return json;
}

}  // namespace rigmap
