#include "evaluation/trajectory_metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "evaluation/matched_poses.h"
#include "geometry/alignment.h"

namespace rigmap {
namespace {

constexpr double kDegreesPerRadian = 57.295779513082320877;
// Summed in this order, so that segments end at the same pose as in the reference scorer.
double Distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  return std::sqrt((d.x() * d.x() + d.y() * d.y()) + d.z() * d.z());
}

std::vector<Eigen::Vector3d> Positions(const std::vector<Rigid3>& poses) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(poses.size());
  for (const Rigid3& pose : poses) positions.push_back(pose.translation);
  return positions;
}

double PathLength(const std::vector<TumPose>& poses) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length_m +=
        Distance(poses[i - 1].world_from_body.translation, poses[i].world_from_body.translation);
  }
  return length_m;
}

double Extent(const std::vector<TumPose>& poses) {
  double extent_m = 0.0;
  for (const TumPose& pose : poses) {
    extent_m = std::max(extent_m, Distance(poses.front().world_from_body.translation,
                                           pose.world_from_body.translation));
  }
  return extent_m;
}

double RmsDistance(const Sim3& truth_from_estimate, const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (truth_from_estimate * estimate[i] - truth[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

AlignedError CompareAligned(const MatchedPoses& matched, double true_path_m) {
  const auto estimate = Positions(matched.estimate), truth = Positions(matched.truth);
  AlignedError error;
  error.ate_se3_m = RmsDistance(AlignPoints(estimate, truth, false), estimate, truth);
  if (true_path_m > 0.0) error.ate_se3_pct = 100.0 * error.ate_se3_m / true_path_m;
  const bool all_coincide =
      std::all_of(estimate.begin(), estimate.end(),
                  [&](const Eigen::Vector3d& x) { return x == estimate.front(); });
  if (!all_coincide) {
    const Sim3 truth_from_estimate = AlignPoints(estimate, truth, true);
    error.scale = truth_from_estimate.scale;
    error.ate_sim3_m = RmsDistance(truth_from_estimate, estimate, truth);
  }
  return error;
}

std::vector<double> DistancesAlong(const std::vector<Rigid3>& poses) {
  std::vector<double> along_m{0.0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    along_m.push_back(along_m.back() + Distance(poses[i - 1].translation, poses[i].translation));
  }
  return along_m;
}

// The errors of KITTI's devkit (Geiger et al. 2012), with one length of segments.
std::optional<RelativeError> CompareSegments(const MatchedPoses& matched, double segment_m) {
  const std::vector<double> along_m = DistancesAlong(matched.truth);
  RelativeError error{.segment_m = segment_m};
  double count = 0.0;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const auto end = std::lower_bound(along_m.begin(), along_m.end(), along_m[i] + error.segment_m);
    if (end == along_m.end()) break;
    const auto j = static_cast<std::size_t>(end - along_m.begin());
    const double length_m = *end - along_m[i];
    const Rigid3 true_motion = matched.truth[i].Inverse() * matched.truth[j];
    const Rigid3 motion = matched.estimate[i].Inverse() * matched.estimate[j];
    error.translation_pct +=
        100.0 * (true_motion.translation - motion.translation).norm() / length_m;
    error.rotation_deg_per_m +=
        kDegreesPerRadian * AngleOf(true_motion.rotation.conjugate() * motion.rotation) / length_m;
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  error.translation_pct /= count;
  error.rotation_deg_per_m /= count;
  return error;
}

// A fifth of the path where nothing else was asked for.
double SegmentLength(const MatchedPoses& matched, double asked_m) {
  constexpr double kMinSegment_m = 1e-6;
  return asked_m > 0.0 ? asked_m
                       : std::max(DistancesAlong(matched.truth).back() / 5.0, kMinSegment_m);
}

HeightError CompareHeights(const MatchedPoses& matched) {
  const auto estimate = Positions(matched.estimate), truth = Positions(matched.truth);
  const Sim3 estimate_from_truth = AlignPoints(estimate, truth, false).Inverse();
  const std::vector<double> along_m = DistancesAlong(matched.truth);
  const double count = static_cast<double>(truth.size());
  double squares = 0.0, sum = 0.0, along_sum = 0.0;
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors_m.push_back(estimate[i].z() - (estimate_from_truth * truth[i]).z());
    squares += errors_m.back() * errors_m.back();
    sum += errors_m.back();
    along_sum += along_m[i];
  }
  double together = 0.0, along_squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double along = along_m[i] - along_sum / count;
    together += along * (errors_m[i] - sum / count);
    along_squares += along * along;
  }
  return {std::sqrt(squares / count), along_squares > 0.0 ? 100.0 * together / along_squares : 0.0};
}

}  // namespace

OptionFields EvaluationOptions::Fields() {
  return {
      {"max_dt_s", &max_dt_s, "s", AtLeast(0.0).UpTo(1e6),
       "A true pose is matched with an estimated one within this: half a frame at 25 Hz, in which "
       "a rover moves a centimetre."},
      {"segment_m", &segment_m, "m", AtLeast(0.0),
       "Length of the stretches that relative errors are taken over. 0: a fifth of the true path, "
       "so that short and long parts both have several."},
  };
}

TrajectoryMetrics CompareTrajectories(std::span<const TumPose> estimate,
                                      std::span<const TumPose> truth,
                                      const EvaluationOptions& options) {
  RequireValid(options);
  const std::vector<TumPose> sorted_estimate = InOrderOfTime(estimate);
  const std::vector<TumPose> sorted_truth = InOrderOfTime(truth);
  const MatchedPoses matched =
      MatchPoses(sorted_estimate, sorted_truth, options.max_dt_s, Tie::kLater);
  TrajectoryMetrics metrics;
  metrics.frames = estimate.size();
  metrics.true_frames = truth.size();
  if (!truth.empty()) {
    metrics.coverage = static_cast<double>(matched.size()) / static_cast<double>(truth.size());
  }
  metrics.true_path_m = PathLength(sorted_truth);
  metrics.estimated_path_m = PathLength(sorted_estimate);
  metrics.extent_m = Extent(sorted_estimate);
  if (matched.size() < kMinMatches) return metrics;
  metrics.aligned = CompareAligned(matched, metrics.true_path_m);
  metrics.height = CompareHeights(matched);
  metrics.relative = CompareSegments(matched, SegmentLength(matched, options.segment_m));
  for (const double segment_m : {5.0, 10.0, 25.0, 50.0, 100.0}) {
    if (const auto error = CompareSegments(matched, segment_m)) metrics.drift.push_back(*error);
  }
  return metrics;
}

}  // namespace rigmap
