// The normal equations of a lens field beside those of poses and calibration. Of this room only.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "adjustment/internal/calibration_blocks.h"
#include "adjustment/internal/reduced_system.h"

namespace rigmap {

// As far as the field is concerned, points eliminated; 6 rows for each unknown pose.
struct FieldSystem {
  Eigen::MatrixXd information, pose_coupling;
  Eigen::Matrix<double, kCalibrationSize, Eigen::Dynamic> calibration_coupling;
  Eigen::VectorXd gradient;
};

// `at` has a field. The result does not depend on the number of threads.
FieldSystem AssembleFieldSystem(const Linearisation& at, const ReducedSystem& system);

// With poses eliminated as well. Information and score are the observations' alone, the calibration
// held; the posterior counts the prior, and the response is the most probable one under it.
struct FieldSolution {
  Eigen::MatrixXd information;
  Eigen::Matrix<double, kCalibrationSize, Eigen::Dynamic> calibration_coupling;
  Eigen::VectorXd score;
  Eigen::LLT<Eigen::MatrixXd> posterior;  // information
  FieldResponse response;
  Eigen::MatrixXd pose_by_field;  // 6 rows for each unknown

  // Columns of the poses' covariance that is due to the field, the calibration held: it is their
  // product with themselves. 6 rows for each unknown.
  Eigen::MatrixXd PoseSpread() const;
};

// `solved_coupling` and `solved_calibration` are the inverse of the poses' block of the system
// times their coupling with the field and with the calibration; `gradient` is the poses'.
FieldSolution SolveField(const Linearisation& at, FieldSystem field,
                         const Eigen::MatrixXd& solved_coupling,
                         const Eigen::MatrixXd& solved_calibration,
                         const Eigen::VectorXd& gradient);

}  // namespace rigmap
