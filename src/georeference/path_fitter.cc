#include "georeference/internal/path_fitter.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/statistics.h"

namespace rigmap {
namespace {

constexpr double kClockStep_s = 0.05;  // of the search: a few centimetres at a rover's speed
constexpr double kMaxSigmas = 4.0;     // normal noise goes beyond once in 3000 fixes
// The median length of a normal vector in the plane, in sigmas (Rayleigh).
constexpr double kMedianLength = 1.17741;
constexpr double kMinReciprocalCondition = 1e-9;

Eigen::Vector2d MeanFrom(const std::vector<PlanePair>& pairs) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const PlanePair& pair : pairs) sum += pair.from;
  return sum / static_cast<double>(pairs.size());
}

// The inverse of `information`, judged after its rows and columns are brought to one scale; nothing
// if it is singular.
std::optional<Eigen::MatrixXd> Inverse(const Eigen::MatrixXd& information) {
  if (!(information.diagonal().minCoeff() > 0.0)) return std::nullopt;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const auto& values = eigen.eigenvalues();
  if (!(values(0) > kMinReciprocalCondition * values(values.size() - 1))) return std::nullopt;
  const Eigen::MatrixXd inverse =
      eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

}  // namespace

std::vector<PlanePair> PathFitter::PairsAt(double clock_offset_s) const {
  std::vector<PlanePair> pairs;
  for (const PlaneFix& fix : fixes_) {
    const double time_s = fix.time_s - clock_offset_s;
    if (const auto antenna = path_.At(time_s)) {
      pairs.push_back({*antenna, fix.position, fix.sigma, path_.VelocityAt(time_s)});
    }
  }
  return pairs;
}

// Where the mean distance after a robust fit is least, per degree of freedom, since offsets near
// the search's ends push fixes off the path. Of equals the one nearest to zero.
double PathFitter::BestOffset(double max_offset_s, std::size_t min_fixes) const {
  const int steps = static_cast<int>(std::floor(max_offset_s / kClockStep_s));
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 2 * steps; ++i) {
    const double offset_s = kClockStep_s * ((i + 1) / 2) * (i % 2 == 1 ? 1.0 : -1.0);
    const auto pairs = PairsAt(offset_s);
    if (pairs.size() < min_fixes) continue;
    const Rigid2 motion = FitRobustly(pairs);
    double sum = 0.0;
    for (const PlanePair& pair : pairs) sum += NormalisedDistance(motion, pair);
    const double mean = sum / static_cast<double>(2 * pairs.size() - 4);
    if (mean < least) least = mean, best = offset_s;
  }
  return best;
}

// Keeps the pairs within kMaxSigmas, judged by the scatter of most where the path errs more than
// the fixes.
void PathFitter::SelectPairs(PathFit& fit) const {
  const auto pairs = PairsAt(fit.clock_offset_s);
  fit.used.clear();
  fit.outliers = 0;
  if (pairs.empty()) return;
  std::vector<double> distances;
  for (const PlanePair& pair : pairs) {
    distances.push_back(NormalisedDistance(fit.plane_from_world, pair));
  }
  const double limit = kMaxSigmas * std::max(1.0, Median(distances) / kMedianLength);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (distances[i] <= limit) {
      fit.used.push_back(pairs[i]);
    } else {
      ++fit.outliers;
    }
  }
}

// One step of Gauss-Newton on the used pairs; returns its length in sigmas. Velocities are means
// over seconds, not the path's own derivative: noise in the poses must not pass for knowledge of
// the clock. A covariance is scaled up where residuals are larger than stated, never down.
double PathFitter::Step(PathFit& fit, bool with_clock) const {
  const int size = with_clock ? 4 : 3;
  fit.determined = false;
  const auto redundancy = 2 * static_cast<int>(fit.used.size()) - size;
  if (redundancy <= 0) return 0.0;
  fit.world_centre = MeanFrom(fit.used);
  const Eigen::Matrix2d turn =
      Eigen::Rotation2Dd(fit.plane_from_world.angle_rad).toRotationMatrix();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  double chi2 = 0.0;
  for (const PlanePair& pair : fit.used) {
    const Eigen::Vector2d arm = turn * (pair.from - fit.world_centre);
    Eigen::Matrix<double, 2, 4> full;
    full << Eigen::Matrix2d::Identity(), Eigen::Vector2d(-arm.y(), arm.x()),
        -(turn * pair.velocity);
    const Eigen::Vector2d inverse_sigma = pair.sigma.cwiseInverse();
    const Eigen::MatrixXd jacobian = inverse_sigma.asDiagonal() * full.leftCols(size);
    const Eigen::Vector2d residual =
        (pair.to - fit.plane_from_world * pair.from).cwiseProduct(inverse_sigma);
    information += jacobian.transpose() * jacobian;
    gradient += jacobian.transpose() * residual;
    chi2 += residual.squaredNorm();
  }
  const auto inverse = Inverse(information);
  if (!inverse) return 0.0;
  const Eigen::VectorXd step = *inverse * gradient;
  fit.covariance.setZero();
  fit.covariance.topLeftCorner(size, size) = std::max(1.0, chi2 / redundancy) * *inverse;
  fit.determined = true;
  const Eigen::Vector2d centre = fit.plane_from_world * fit.world_centre + step.head<2>();
  fit.plane_from_world.angle_rad =
      std::remainder(fit.plane_from_world.angle_rad + step(2), 2.0 * EIGEN_PI);
  fit.plane_from_world.translation = Eigen::Vector2d::Zero();
  fit.plane_from_world.translation = centre - fit.plane_from_world * fit.world_centre;
  if (with_clock) fit.clock_offset_s += step(3);
  return std::sqrt(step.dot(gradient));
}

PathFit PathFitter::Refine(double clock_offset_s, bool with_clock) const {
  constexpr int kIterations = 30;
  constexpr double kConverged_sigmas = 1e-6;
  PathFit fit;
  fit.clock_offset_s = clock_offset_s;
  const auto pairs = PairsAt(clock_offset_s);
  if (pairs.empty()) return fit;
  fit.plane_from_world = FitRobustly(pairs);
  SelectPairs(fit);
  for (int i = 0; i < kIterations; ++i) {
    const double length_sigmas = Step(fit, with_clock);
    SelectPairs(fit);
    if (length_sigmas < kConverged_sigmas) break;
  }
  return fit;
}

}  // namespace rigmap
