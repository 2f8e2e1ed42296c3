#include "adjustment/internal/calibration_border.h"

#include <cmath>

#include "adjustment/calibration.h"
#include "adjustment/internal/pose_matrix.h"

namespace rigmap {
namespace {

// Nothing where the system is singular. Many times faster than Factorised, which serves whoever
// wants the inverse.
std::optional<PoseMatrix> FactorisedByBlocks(const ReducedSystem& system) {
  std::vector<PoseMatrix::Pair> pairs;
  std::vector<Matrix6d> blocks;
  for (const auto& [at, block] : system.blocks) {
    pairs.emplace_back(at.second, at.first);
    blocks.push_back(block);
  }
  std::optional<PoseMatrix> matrix(std::in_place, system.unknowns, pairs);
  if (!matrix->Factorise(blocks)) matrix.reset();
  return matrix;
}

// What windows have in common that no model knows (half of what perspective bends, the phase
// between pixels): about 0.0022 px (rms) in all fields that the parameters make together, a little
// of it in each. It follows from the Monte Carlo over simulated loops, which turn one way only and
// whose principal points err to one side, all of them, by more than noise lets them.
double CoherentShare(double observations, double noise_px) {
  constexpr double kOfEachPx = 0.0005;
  return observations * std::pow(kOfEachPx / noise_px, 2);
}

// What poses and the field leave to the calibration.
void EliminateField(const Linearisation& at, const FieldSolution& field,
                    CalibrationEquations& equations) {
  const FieldResponse& response = field.response;
  equations.information += field.calibration_coupling * response.by_calibration;
  equations.score -= field.calibration_coupling * response.step;
  const auto by_calibration = response.by_calibration.transpose();
  equations.of_field = {
      -at.field_information * (by_calibration * (at.field->Values() + response.step)),
      at.field_information * (by_calibration * response.by_calibration)};
}

}  // namespace

std::optional<CalibrationSolution> SolveBorder(const ReducedSystem& system,
                                               const Linearisation& at) {
  const auto factor = FactorisedByBlocks(system);
  if (!factor) return std::nullopt;
  Eigen::MatrixXd coupling(6 * system.unknowns, static_cast<int>(kCalibrationSize));
  Eigen::VectorXd gradient(6 * system.unknowns);
  for (int i = 0; i < system.unknowns; ++i) {
    coupling.middleRows<6>(6 * i) = system.pose_calibration[i];
    gradient.segment<6>(6 * i) = system.pose_gradient[i];
  }
  Eigen::MatrixXd by_calibration = -factor->Solve(coupling);
  Eigen::VectorXd step = -factor->Solve(gradient);
  CalibrationSolution solution;
  CalibrationEquations& equations = solution.equations;
  equations.information = system.calibration + coupling.transpose() * by_calibration;
  equations.score = -(system.calibration_gradient + by_calibration.transpose() * gradient);
  if (at.field != nullptr) {
    solution.equations_with_field_held = equations;
    FieldSystem field = AssembleFieldSystem(at, system);
    const Eigen::MatrixXd solved = factor->Solve(field.pose_coupling);
    solution.field = SolveField(at, std::move(field), solved, -by_calibration, gradient);
    EliminateField(at, *solution.field, equations);
    step += solution.field->pose_by_field * solution.field->response.step;
    by_calibration += solution.field->pose_by_field * solution.field->response.by_calibration;
  }
  solution.responses.assign(at.left_from_world.size(), {});
  for (std::size_t frame = 0; frame < at.left_from_world.size(); ++frame) {
    PoseResponse& response = solution.responses[frame];
    if (system.IsUnknown(frame)) {
      response.step = step.segment<6>(6 * system.unknown[frame]);
      response.by_calibration = by_calibration.middleRows<6>(6 * system.unknown[frame]);
    }
    if (const int turn = system.turn[frame]; turn >= 0) {
      response.turn_step = step.segment<3>(6 * turn);
      response.turn_by_calibration = by_calibration.middleRows<3>(6 * turn);
    }
  }
  CalibrationBlocks blocks = DivideCalibration(
      at, solution.responses, solution.field ? solution.field->response : FieldResponse{});
  equations.score_covariance = blocks.score_covariance / system.Redundancy();
  equations.coherent = CoherentShare(0.5 * system.coordinates, at.noise_px);
  equations.stretches = std::move(blocks.stretches);
  equations.regions = std::move(blocks.regions);
  if (!RotationAndFocalStep(equations)) return std::nullopt;
  return solution;
}

Rigid3 Moved(const Rigid3& left_from_world, const PoseResponse& response,
             const CalibrationVector& calibration_step) {
  const Vector6d by = response.step + response.by_calibration * calibration_step;
  return {(ExpRotation(by.head<3>()) * left_from_world.rotation).normalized(),
          left_from_world.translation + by.tail<3>()};
}

std::optional<CalibrationSolution> SolveCalibration(const Linearisation& at) {
  const ReducedSystem system = AssembleReducedSystem(at);
  if (system.unknowns == 0) return std::nullopt;
  return SolveBorder(system, at);
}

}  // namespace rigmap
