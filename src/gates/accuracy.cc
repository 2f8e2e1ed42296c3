#include "gates/accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigmap {
namespace {

constexpr double kSigmas95 = 1.960;
// Of a way shorter than this it is millimetres that count, not shares of it.
constexpr double kShortWay_m = 1.0;

// From one measured frame to the next: a guess makes no way.
double PathLength(const Trajectory& trajectory) {
  double path_m = 0.0;
  const TimedPose* before = nullptr;
  for (const TimedPose& pose : trajectory) {
    if (!pose.IsMeasured()) continue;
    if (before) {
      path_m += (pose.world_from_left.translation - before->world_from_left.translation).norm();
    }
    before = &pose;
  }
  return path_m;
}

// Relative sigma of the distance from the first measured frame to the farthest one.
std::optional<double> FarthestSigma(const Trajectory& trajectory) {
  if (trajectory.empty()) return std::nullopt;
  const Eigen::Vector3d start = trajectory[FirstMeasured(trajectory)].world_from_left.translation;
  double farthest_m = 0.0;
  std::optional<double> sigma;
  for (const TimedPose& pose : trajectory) {
    if (!pose.IsMeasured()) continue;
    const Eigen::Vector3d way = pose.world_from_left.translation - start;
    if (way.norm() <= farthest_m) continue;
    farthest_m = way.norm();
    const Eigen::Vector3d direction = way / farthest_m;
    const double variance_m2 = direction.dot(pose.position_covariance * direction);
    sigma = std::isfinite(variance_m2)
                ? std::sqrt(std::max(0.0, variance_m2)) / std::max(kShortWay_m, farthest_m)
                : std::numeric_limits<double>::infinity();
  }
  return sigma;
}

// Relative sigma of the factor that a similarity alignment would find, of errors that add up along
// the way: two poses share those of the earlier one. To first order the factor's error is the sum
// of position errors along the ways from the mean position, over the sum of squares of these.
std::optional<double> SimilaritySigma(const Trajectory& trajectory) {
  std::vector<const TimedPose*> poses;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const TimedPose& pose : trajectory) {
    if (!pose.IsMeasured()) continue;
    poses.push_back(&pose);
    mean += pose.world_from_left.translation;
  }
  if (poses.empty()) return std::nullopt;
  const auto count = static_cast<double>(poses.size());
  mean /= count;
  double squares_m2 = 0.0, variance_m4 = 0.0;
  Eigen::Vector3d later = Eigen::Vector3d::Zero();  // sum of the ways of later poses
  for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
    const Eigen::Vector3d way = (*pose)->world_from_left.translation - mean;
    variance_m4 += way.dot((*pose)->position_covariance * (way + 2.0 * later));
    squares_m2 += way.squaredNorm();
    later += way;
  }
  if (!std::isfinite(variance_m4)) return std::numeric_limits<double>::infinity();
  constexpr double kMeanSquareOfWay = 1.0 / 12.0;  // about its middle, of a straight one
  return std::sqrt(std::max(0.0, variance_m4)) /
         std::max(squares_m2, count * kShortWay_m * kShortWay_m * kMeanSquareOfWay);
}

// Errors that grow with the distance, as that of a calibration does, are a random walk's least
// where a path is straight, and its farthest way's most; a bend in its midst is in no distance.
std::optional<double> ScaleSigmaOf(const Trajectory& trajectory) {
  const auto farthest = FarthestSigma(trajectory), similarity = SimilaritySigma(trajectory);
  return farthest && similarity ? std::max(*farthest, *similarity) : farthest;
}

}  // namespace

bool IsAboutAccuracy(const std::string& gate) {
  return gate == "scale_95_pct" || gate == "position_95_pct";
}

double Radius95(const Eigen::Matrix3d& covariance) {
  constexpr double kNormal95 = 1.645;
  // What is not a number must not pass for what is known.
  if (!covariance.allFinite()) return std::numeric_limits<double>::infinity();
  const double trace = covariance.trace();
  if (!(trace > 0.0)) return 0.0;
  const double freedom = trace * trace / (covariance * covariance).trace();
  const double spread = 2.0 / (9.0 * freedom);
  return std::sqrt(trace * std::pow(1.0 - spread + kNormal95 * std::sqrt(spread), 3.0));
}

Accuracy AccuracyOf(const Trajectory& trajectory, const Adjustment& adjustment,
                    const StereoRig& rig, const BesideCovariances& beside) {
  Accuracy accuracy{.path_m = PathLength(trajectory)};
  const auto measured = std::ranges::count_if(trajectory, &TimedPose::IsMeasured);
  if (measured < 2) return accuracy;
  const bool is_way = accuracy.path_m >= rig.Baseline();
  if (is_way && !std::isfinite(beside.calibration_scale_sigma)) {
    accuracy.scale_95_pct = accuracy.position_95_pct = beside.calibration_scale_sigma;
    return accuracy;
  }
  const double of_baseline = rig.baseline_sigma_m.value_or(0.0) / rig.Baseline();
  const double of_all_lengths =
      std::hypot(of_baseline, beside.calibration_scale_sigma, beside.depth_contradiction);
  const auto scale = adjustment.scale_sigma || !beside.positions_known ? adjustment.scale_sigma
                                                                       : ScaleSigmaOf(trajectory);
  if (is_way && scale)
    accuracy.scale_95_pct = 100.0 * kSigmas95 * std::hypot(*scale, of_all_lengths);
  if (beside.calibration_scale_sigma > 0.0 && scale) {
    accuracy.noise_95_pct = 100.0 * kSigmas95 * *scale;
  } else if (const auto& noise = adjustment.scale_sigma_of_noise) {
    accuracy.noise_95_pct = 100.0 * kSigmas95 * *noise;
  }
  if (rig.baseline_sigma_m) accuracy.baseline_95_pct = 100.0 * kSigmas95 * of_baseline;
  if (!beside.positions_known) return accuracy;
  const Eigen::Vector3d start = trajectory[FirstMeasured(trajectory)].world_from_left.translation;
  for (const TimedPose& pose : trajectory) {
    if (!pose.IsMeasured()) continue;
    const Eigen::Vector3d way = pose.world_from_left.translation - start;
    const double radius_m = Radius95(pose.position_covariance +
                                     of_all_lengths * of_all_lengths * way * way.transpose());
    accuracy.position_95_m = std::max(accuracy.position_95_m.value_or(0.0), radius_m);
  }
  if (accuracy.position_95_m) {
    accuracy.position_95_pct =
        100.0 * *accuracy.position_95_m / std::max(kShortWay_m, accuracy.path_m);
  }
  return accuracy;
}

}  // namespace rigmap
