#include "evaluation/internal/rock_deformation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "evaluation/internal/rock_sheets.h"

namespace rigmap {
namespace {

constexpr double kFitGate_m = 0.06;            // farther points may be another surface
constexpr double kHuber_m = 0.005;             // the noise of a map that is good, and half more
constexpr std::size_t kMinPointsOfPatch = 3;   // fewer may all be stray
constexpr std::size_t kSpareObservations = 3;  // beyond the unknowns
constexpr int kMaxRounds = 25;
constexpr double kLastStep = 5e-5;      // m, and of a stretch: less than is printed
constexpr double kMaxStretchOff = 0.5;  // beyond, it is no longer this rock
constexpr double kLeastResidual_m = 1e-9;
constexpr double kLeastWeight = 1e-9;
constexpr double kLeastSigma_m = 0.001;    // the truth's own grain
constexpr double kPatchesAlike = 2.0;      // neighbours were measured together: so many count once
constexpr double kCountedDirection = 1.0;  // whole patches that face it
constexpr double kPseudoInverseRank = 1e-15;  // of the largest singular value

constexpr Eigen::Index kShiftUnknowns = 3, kAllUnknowns = 6;
using Vector6d = Eigen::Matrix<double, kAllUnknowns, 1>;

// Translation (m, the truth's axes) and by how much each stretch exceeds 1 (along the view's).
struct Deformation {
  Vector6d parameters = Vector6d::Zero();

  Eigen::Vector3d Shift() const { return parameters.head<3>(); }
  Eigen::Vector3d Stretch() const { return parameters.tail<3>().array() + 1.0; }
};

// Points of the map by the patches of the core that they show.
struct CoreObservations {
  std::vector<Eigen::Vector3d> x;
  std::vector<std::uint32_t> patch;  // in parallel
  std::vector<std::uint32_t> used;   // the patches that are observations
};

CoreObservations Observe(std::span<const Eigen::Vector3d> map_points, const RockTruth& truth) {
  CoreObservations observations;
  std::vector<std::size_t> points_of(truth.core.patch_area.size(), 0);
  for (const auto& x : map_points) {
    const auto nearest = truth.all.tree.Nearest(x, kFitGate_m);
    if (!nearest || !truth.core.patch_of[nearest->index]) continue;
    observations.x.push_back(x);
    observations.patch.push_back(*truth.core.patch_of[nearest->index]);
    ++points_of[observations.patch.back()];
  }
  for (std::uint32_t k = 0; k < points_of.size(); ++k) {
    if (points_of[k] >= kMinPointsOfPatch) observations.used.push_back(k);
  }
  return observations;
}

// What the points tell about a deformation, once it is undone.
struct PointReadings {
  std::vector<Eigen::Vector3d> x_true;  // the rock's nearest point
  std::vector<double> offset_m;         // from its tangent plane, as it is in the map
  std::vector<Vector6d> slope;          // of the offset, by the parameters
};

double HuberWeight(double residual_m) {
  return std::min(1.0, kHuber_m / std::max(std::abs(residual_m), kLeastResidual_m));
}

// Observation = design * (parameters - those at which it was read) + noise; a row is a patch.
struct PatchEquations {
  Eigen::VectorXd offset_m, area, weight;  // weight: the area, times Huber's
  Eigen::MatrixXd design;

  Eigen::MatrixXd NormalMatrix() const { return design.transpose() * weight.asDiagonal() * design; }
  Eigen::VectorXd NormalVector() const {
    return design.transpose() * weight.cwiseProduct(offset_m);
  }
  // Of what the unknowns leave, unbiased, by area.
  double MeanSquare() const {
    const auto count = static_cast<double>(offset_m.size());
    return area.dot(offset_m.cwiseAbs2()) / area.sum() * count /
           (count - static_cast<double>(design.cols()));
  }
};

struct DeformationFit {
  Deformation deformation;
  Eigen::MatrixXd normal_matrix, covariance;
  double rms_m = 0.0;  // of the patches
  PointReadings readings;
};

class DeformationProblem {
 public:
  DeformationProblem(std::span<const Eigen::Vector3d> map_points, const RockTruth& truth,
                     const Eigen::Matrix3d& axes)
      : truth_(truth), axes_(axes), observed_(Observe(map_points, truth)) {}

  std::optional<DeformationFit> Fit(Eigen::Index unknowns) const;

 private:
  PointReadings Read(const Deformation& deformation) const;
  PatchEquations AverageOverPatches(const PointReadings& readings, Eigen::Index unknowns) const;

  const RockTruth& truth_;
  const Eigen::Matrix3d& axes_;
  CoreObservations observed_;
};

PointReadings DeformationProblem::Read(const Deformation& deformation) const {
  const Eigen::Vector3d stretch = deformation.Stretch(), centre = truth_.core.centre;
  PointReadings readings;
  for (const auto& x : observed_.x) {
    const Eigen::Vector3d arm = axes_ * (x - centre - deformation.Shift());
    const Eigen::Vector3d undone = centre + axes_.transpose() * arm.cwiseQuotient(stretch);
    const auto nearest = truth_.own.tree.Nearest(undone, std::numeric_limits<double>::infinity());
    const Eigen::Vector3d& x_true = truth_.own.x[nearest->index];
    const Eigen::Vector3d& normal = truth_.own.normal[nearest->index];
    const Eigen::Vector3d normal_in_view = axes_ * normal;
    // By this factor undoing the stretch changes distances from the plane.
    const double factor = normal_in_view.cwiseQuotient(stretch).norm();
    readings.x_true.push_back(x_true);
    readings.offset_m.push_back((undone - x_true).dot(normal) / factor);
    Vector6d slope;
    slope << normal, normal_in_view.cwiseProduct(axes_ * (x_true - centre));
    readings.slope.push_back(slope / factor);
  }
  return readings;
}

PatchEquations DeformationProblem::AverageOverPatches(const PointReadings& readings,
                                                      Eigen::Index unknowns) const {
  const auto patches = static_cast<Eigen::Index>(truth_.core.patch_area.size());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(patches), offset = weight;
  Eigen::Matrix<double, Eigen::Dynamic, kAllUnknowns> slope;
  slope.setZero(patches, kAllUnknowns);
  for (std::size_t i = 0; i < observed_.patch.size(); ++i) {
    const double w = HuberWeight(readings.offset_m[i]);
    weight(observed_.patch[i]) += w;
    offset(observed_.patch[i]) += w * readings.offset_m[i];
    slope.row(observed_.patch[i]) += w * readings.slope[i].transpose();
  }
  const auto count = static_cast<Eigen::Index>(observed_.used.size());
  PatchEquations equations{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::VectorXd(count),
                           Eigen::MatrixXd(count, unknowns)};
  for (Eigen::Index row = 0; row < count; ++row) {
    const auto patch = observed_.used[static_cast<std::size_t>(row)];
    const double total = std::max(weight(patch), kLeastWeight);
    equations.offset_m(row) = offset(patch) / total;
    equations.area(row) = truth_.core.patch_area[patch];
    equations.weight(row) = equations.area(row) * HuberWeight(equations.offset_m(row));
    equations.design.row(row) = slope.row(patch).head(unknowns) / total;
  }
  return equations;
}

Eigen::JacobiSVD<Eigen::MatrixXd> Decompose(const Eigen::MatrixXd& square, double rank) {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(square, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(rank);
  return svd;
}

// The solution of least length, as the equations may be short of rank.
Eigen::VectorXd SolveStep(const Eigen::MatrixXd& normal_matrix,
                          const Eigen::VectorXd& normal_vector) {
  const double rank =
      std::numeric_limits<double>::epsilon() * static_cast<double>(normal_matrix.rows());
  return Decompose(normal_matrix, rank).solve(normal_vector);
}

Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& square) {
  return Decompose(square, kPseudoInverseRank)
      .solve(Eigen::MatrixXd::Identity(square.rows(), square.cols()));
}

std::optional<DeformationFit> DeformationProblem::Fit(Eigen::Index unknowns) const {
  if (observed_.used.size() < static_cast<std::size_t>(unknowns) + kSpareObservations) {
    return std::nullopt;
  }
  DeformationFit fit;
  PatchEquations equations;
  for (int round = 0; round < kMaxRounds; ++round) {
    fit.readings = Read(fit.deformation);
    equations = AverageOverPatches(fit.readings, unknowns);
    fit.normal_matrix = equations.NormalMatrix();
    const Eigen::VectorXd step = SolveStep(fit.normal_matrix, equations.NormalVector());
    auto& parameters = fit.deformation.parameters;
    parameters.head(unknowns) += step;
    parameters.tail<3>() =
        parameters.tail<3>().cwiseMax(-kMaxStretchOff).cwiseMin(kMaxStretchOff).eval();
    if (step.cwiseAbs().maxCoeff() < kLastStep) break;
  }
  fit.rms_m = std::sqrt(equations.MeanSquare());
  fit.covariance = PseudoInverse(fit.normal_matrix) * kPatchesAlike *
                   std::pow(std::max(fit.rms_m, kLeastSigma_m), 2.0);
  return fit;
}

// The eigenvectors of a normal matrix that are determined, in columns.
Eigen::MatrixXd CountedDirections(const Eigen::Matrix3d& normal_matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal_matrix);
  const Eigen::Index counted = (solver.eigenvalues().array() >= kCountedDirection).count();
  return solver.eigenvectors().rightCols(counted);
}

Eigen::Vector3d Sigmas(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

std::optional<RockShift> FitShift(std::span<const Eigen::Vector3d> map_points,
                                  const RockTruth& truth, const Eigen::Matrix3d& axes) {
  const auto fit = DeformationProblem(map_points, truth, axes).Fit(kShiftUnknowns);
  if (!fit) return std::nullopt;
  const Eigen::MatrixXd counted = CountedDirections(fit->normal_matrix);
  if (counted.cols() == 0) return std::nullopt;
  RockShift shift;
  shift.along_axes_m = axes * (counted * (counted.transpose() * fit->deformation.Shift()));
  shift.sigma_m = Sigmas(axes * fit->covariance * axes.transpose());
  shift.directions = static_cast<int>(counted.cols());
  return shift;
}

std::optional<RockStretch> FitStretch(std::span<const Eigen::Vector3d> map_points,
                                      const RockTruth& truth, const Eigen::Matrix3d& axes) {
  const auto fit = DeformationProblem(map_points, truth, axes).Fit(kAllUnknowns);
  if (!fit) return std::nullopt;
  RockStretch stretch;
  stretch.along_axes = fit->deformation.Stretch();
  stretch.sigma = Sigmas(fit->covariance.bottomRightCorner<3, 3>());
  stretch.rms_m = fit->rms_m;
  stretch.doubled_share = ShareInTwoSheets(fit->readings.x_true, fit->readings.offset_m);
  return stretch;
}

}  // namespace rigmap
