#include "adjustment/internal/lens_description.h"

#include <spdlog/spdlog.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "adjustment/calibration.h"
#include "adjustment/internal/calibration_blocks.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

// How much better stretches of the part fit a field that the residuals of all the others ask for,
// points, poses and calibration held.
LeftOutGain GainOfField(const Linearisation& at, int stretches, double inflation) {
  struct Asked {
    Eigen::VectorXd residual, weight;  // per parameter
  };
  const int size = at.field->Size();
  std::vector<Asked> asked(stretches, {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)});
  Asked all = asked.front();
  const std::vector<int> stretch_of = StretchesOf(at, stretches);
  for (std::size_t i = 0; i < at.points.size(); ++i) {
    Asked& here = asked[stretch_of[i]];
    for (const PointObservation& o : at.points[i].observations) {
      const auto seen = Reproject(at.rig, o.eye, *at.left_from_world[o.frame], at.points[i].x);
      if (!seen) continue;
      const Eigen::Vector2d residual = seen->pixel - o.pixel;
      const LensField::Support support = at.field->At(o.eye, o.pixel);
      for (int k = 0; k < 4; ++k) {
        const double share = at.WeightOf(residual) * support.weight[k];
        here.residual.segment<2>(support.parameter[k]) += share * residual;
        here.weight.segment<2>(support.parameter[k]).array() += share;
      }
    }
  }
  for (const Asked& here : asked) {
    all.residual += here.residual;
    all.weight += here.weight;
  }
  LeftOutGain found{.blocks = stretches};
  for (const Asked& left_out : asked) {
    const Eigen::ArrayXd step = (all.residual - left_out.residual).array() /
                                ((all.weight - left_out.weight).array() + at.field_information);
    // Of pixels between nodes no more than this is lost: squares are convex.
    found.Add((step * (left_out.residual.array() - 0.5 * step * left_out.weight.array())).sum() /
              inflation);
  }
  return found;
}

// The calibration is left free under its prior, which its information and score contain.
double MostProbableSigma(const Eigen::VectorXd& field, const FieldSolution& solution,
                         const CalibrationMatrix& calibration_information,
                         const CalibrationVector& calibration_score, double inflation,
                         double sigma_px) {
  constexpr int kIterations = 50;
  constexpr double kLeastPx = 1e-6;
  // The calibration is eliminated, then all is turned to where the observations' information is
  // diagonal.
  const Eigen::LDLT<CalibrationMatrix> calibration(calibration_information);
  const Eigen::MatrixXd coupling = solution.calibration_coupling;
  const Eigen::MatrixXd information =
      (solution.information - coupling.transpose() * calibration.solve(coupling)) / inflation;
  const Eigen::VectorXd score =
      (solution.score - coupling.transpose() * calibration.solve(calibration_score)) / inflation;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const Eigen::ArrayXd told = solver.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd asked =
      (solver.eigenvectors().transpose() * (score + information * field)).array();
  double variance = sigma_px * sigma_px;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::ArrayXd posterior = told + 1.0 / variance;
    const double parameters = (told / posterior).sum();
    const double better = (asked / posterior).square().sum() / parameters;
    if (!(better > kLeastPx * kLeastPx)) return kLeastPx;
    variance = better;
  }
  return std::sqrt(variance);
}

}  // namespace

bool LensDescription::Begin(const Linearisation& at, const AdjustmentOptions& options) {
  constexpr int kStretchesPerDissenter = 8;
  if (options.lens_field_px == 0.0) return false;
  const auto solution = SolveCalibration(at);
  if (!solution) return false;
  // What stretches and regions contradict each other by is what a field is asked to mend.
  inflation_ = InflationOfPoses(solution->equations, options);
  SetSigma(0.5 * options.lens_field_px);
  Linearisation with_field = at;
  with_field.field = &field_;
  with_field.field_information = information_;
  const LeftOutGain gain = GainOfField(with_field, StretchCount(at), inflation_);
  spdlog::info("a field of the lens: stretches left out gain {:.1f}, {} of {} against", gain.sum,
               gain.against, gain.blocks);
  if (gain.sum > 0.5 * options.refine_sigmas * options.refine_sigmas &&
      gain.against <= gain.blocks / kStretchesPerDissenter) {
    return true;
  }
  information_ = 0.0;
  return false;
}

void LensDescription::TakeSigma(const Linearisation& at, const CalibrationSolution& solution,
                                const CalibrationPrior& prior, const CalibrationVector& correction,
                                const AdjustmentOptions& options) {
  const CalibrationMatrix prior_information = inflation_ * prior.information;
  const CalibrationEquations& held = solution.equations_with_field_held;
  const double sigma_px =
      MostProbableSigma(at.field->Values(), *solution.field, held.information + prior_information,
                        held.score - prior_information * correction, inflation_, sigma_px_);
  SetSigma(std::min(sigma_px, options.lens_field_px));
  spdlog::info("a field of the lens: sigma {:.4f} px", sigma_px);
}

}  // namespace rigmap
