#include "workflows/stages/reference_output.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/statistics.h"
#include "evaluation/map_over_truth.h"
#include "evaluation/prism_metrics.h"
#include "georeference/local_frame.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

double ToTenthOfMillimetre(double m) { return std::round(1e4 * m) / 1e4; }

Json Row(StampNs stamp_ns, const Eigen::Vector3d& x) {
  return {stamp_ns, ToTenthOfMillimetre(x.x()), ToTenthOfMillimetre(x.y()),
          ToTenthOfMillimetre(x.z())};
}

std::vector<TumPose> TumPosesOf(const Trajectory& trajectory) {
  std::vector<TumPose> poses;
  for (const TimedPose& pose : trajectory) poses.push_back({pose.stamp_ns, pose.world_from_left});
  return poses;
}

void PutTruth(const SurveyedResult& result, const Json& metrics, const EvaluationOptions& options,
              Json& reference) {
  if (result.truth.path.empty() || IsPrismFile(result.truth.path) || result.trajectory.empty())
    return;
  const std::vector<TumPose> estimate = TumPosesOf(result.trajectory);
  const std::vector<TumPose> truth = ReadTruth(result.truth.path);
  const auto truth_from_world = AlignWithTruth(estimate, truth, options);
  if (!truth_from_world) return;
  const Rigid3 world_from_truth = truth_from_world->Inverse();
  const auto margin_ns = static_cast<StampNs>(1e9 * options.max_dt_s);
  for (const TumPose& pose : truth) {
    if (pose.stamp_ns < estimate.front().stamp_ns - margin_ns) continue;
    if (pose.stamp_ns > estimate.back().stamp_ns + margin_ns) continue;
    const Eigen::Vector3d x = world_from_truth * pose.world_from_body.translation;
    reference["truth"].push_back(Row(pose.stamp_ns, x));
  }
  if (!metrics.contains("rocks")) return;
  // Rocks are known from above; a tilt between the worlds moves them by millimetres.
  const double height_m = truth.front().world_from_body.translation.z();
  for (const Json& rock : metrics["rocks"]["each"]) {
    const Eigen::Vector3d x = world_from_truth * Eigen::Vector3d(rock["x"], rock["y"], height_m);
    reference["rocks"].push_back({{"size", rock["size"]},
                                  {"x", ToTenthOfMillimetre(x.x())},
                                  {"y", ToTenthOfMillimetre(x.y())}});
  }
}

// A trajectory of one pose or more.
bool LiesWithin(const Trajectory& trajectory, StampNs stamp_ns) {
  return stamp_ns >= trajectory.front().stamp_ns && stamp_ns <= trajectory.back().stamp_ns;
}

const TimedPose& NearestInTime(const Trajectory& trajectory, StampNs stamp_ns) {
  return *std::ranges::min_element(
      trajectory, {}, [&](const TimedPose& pose) { return std::abs(pose.stamp_ns - stamp_ns); });
}

// Where the tracked prism has the left eye, at the height of the pose: from above alone.
void PutPrism(const SurveyedResult& result, Json& reference) {
  if (result.truth.path.empty() || !IsPrismFile(result.truth.path)) return;
  const std::vector<PrismPosition> track = ReadPrismFile(result.truth.path);
  const auto fit = ComparePrism(TumPosesOf(result.trajectory), track).rigid;
  if (!fit) return;
  const Eigen::Rotation2Dd world_from_track(-fit->heading_rad);
  const auto offset_ns = static_cast<StampNs>(1e9 * fit->clock_offset_s);
  for (const PrismPosition& prism : track) {
    const StampNs stamp_ns = prism.stamp_ns - offset_ns;
    if (!LiesWithin(result.trajectory, stamp_ns)) continue;
    const Rigid3& world_from_left = NearestInTime(result.trajectory, stamp_ns).world_from_left;
    const Eigen::Vector3d lever = world_from_left.rotation * fit->prism_in_body;
    const Eigen::Vector2d x = world_from_track * (prism.position - fit->shift) - lever.head<2>();
    reference["prism"].push_back(Row(stamp_ns, {x.x(), x.y(), world_from_left.translation.z()}));
  }
}

// Where a fix has the left eye, in the plane of the alignment and with the fix's height.
struct AlignedFix {
  StampNs stamp_ns;  // by the images' clock
  Eigen::Vector3d left_eye;
  double world_height_m;  // of the pose
};

std::vector<AlignedFix> AlignFixes(const SurveyedResult& result, const RtkAlignment& alignment) {
  const LocalFrame plane(alignment.plane_origin);
  const Rigid2 world_from_plane = alignment.plane_from_world.Inverse();
  const auto offset_ns = static_cast<StampNs>(1e9 * alignment.clock_offset_s);
  std::vector<AlignedFix> aligned;
  for (const GnssFix& fix : result.truth.fixes) {
    const StampNs stamp_ns = fix.stamp_ns - offset_ns;
    if (fix.status != kRtkFixed || !LiesWithin(result.trajectory, stamp_ns)) continue;
    const Eigen::Vector3d enu = plane.ToEnu({fix.latitude_deg, fix.longitude_deg, fix.altitude_m});
    const TimedPose& pose = NearestInTime(result.trajectory, stamp_ns);
    const Eigen::Vector3d lever =
        pose.world_from_left.rotation * result.rig.antenna_in_left.value();
    const Eigen::Vector2d antenna = world_from_plane * enu.head<2>();
    aligned.push_back({stamp_ns, Eigen::Vector3d(antenna.x(), antenna.y(), enu.z()) - lever,
                       pose.world_from_left.translation.z()});
  }
  return aligned;
}

// Heights above the world's origin, of which the alignment says nothing, as the poses have them in
// the median.
void PutFixes(const SurveyedResult& result, const RtkAlignment& alignment, Json& reference) {
  const std::vector<AlignedFix> aligned = AlignFixes(result, alignment);
  if (aligned.empty()) return;
  std::vector<double> lifts_m;
  for (const AlignedFix& fix : aligned) lifts_m.push_back(fix.world_height_m - fix.left_eye.z());
  const Eigen::Vector3d lift(0.0, 0.0, Median(std::move(lifts_m)));
  for (const AlignedFix& fix : aligned) {
    reference["rtk"].push_back(Row(fix.stamp_ns, fix.left_eye + lift));
  }
}

// Where the evaluation laid them.
void PutSurveyedRocks(const Json& metrics, Json& reference) {
  if (!metrics.contains("surveyed_rocks") || reference.contains("rocks")) return;
  for (const Json& rock : metrics["surveyed_rocks"]["each"]) {
    reference["rocks"].push_back({{"size", rock["size"]}, {"x", rock["x_m"]}, {"y", rock["y_m"]}});
  }
}

}  // namespace

Json DescribeReference(const SurveyedResult& result, const Json& metrics,
                       const EvaluationOptions& evaluation, const RtkAlignmentOptions& options) {
  Json reference;
  PutTruth(result, metrics, evaluation, reference);
  PutPrism(result, reference);
  const auto& antenna_in_left = result.rig.antenna_in_left;
  if (!result.truth.fixes.empty() && antenna_in_left) {
    const RtkFit fit = AlignToRtk(result.truth.fixes, result.trajectory, *antenna_in_left, options);
    if (fit.alignment) {
      PutFixes(result, *fit.alignment, reference);
      PutSurveyedRocks(metrics, reference);
    }
  }
  return reference;
}

}  // namespace rigmap
