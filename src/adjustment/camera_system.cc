#include "adjustment/internal/camera_system.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <map>

#include "adjustment/calibration.h"
#include "adjustment/internal/calibration_blocks.h"
#include "adjustment/internal/datum_frames.h"
#include "adjustment/internal/score_clusters.h"
#include "adjustment/internal/selected_inverse.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

constexpr int kShared = kCalibrationSize;
constexpr double kUnknownVariance = 1e6;
using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
using PoseShared = Eigen::Matrix<double, 6, kShared>;
using SharedPoint = Eigen::Matrix<double, kShared, 3>;
using PosePoint = Eigen::Matrix<double, 6, 3>;

// Blocks of the reduced system. Frames are numbered in the order in which they were first met.
class ReducedSystem {
 public:
  explicit ReducedSystem(std::vector<int> datum_frames)
      : datum_frames_(std::move(datum_frames)), unknown_(datum_frames_.size(), -1) {
    for (std::size_t i = 0; i < datum_frames_.size(); ++i) {
      if (datum_frames_[i] == static_cast<int>(i)) unknown_[i] = kFixed;
    }
  }

  void AddPoint(const AdjustedPoint& point, const std::vector<std::optional<Rigid3>>& poses,
                const StereoRig& rig, double noise_px, double huber_px) {
    Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
    Eigen::Vector3d v_gradient = Eigen::Vector3d::Zero();
    SharedPoint shared_point = SharedPoint::Zero();
    std::map<int, PosePoint> pose_point;
    std::map<int, Vector6d> pose_score;
    CalibrationVector shared_score = CalibrationVector::Zero();
    coordinates_ += 2.0 * static_cast<double>(point.observations.size());
    point_unknowns_ += 3.0;
    for (const PointObservation& observation : point.observations) {
      const auto at = Reproject(rig, observation.eye, *poses[observation.frame], point.x);
      if (!at) continue;
      const Eigen::Vector2d residual = at->pixel - observation.pixel;
      const double weight =
          std::min(1.0, huber_px / std::max(residual.norm(), 1e-9)) / (noise_px * noise_px);
      const ReprojectionJacobians& j = at->jacobians;
      const auto& shared = j.calibration;
      v += weight * j.point.transpose() * j.point;
      v_gradient += weight * j.point.transpose() * residual;
      shared_point += weight * shared.transpose() * j.point;
      shared_ += weight * shared.transpose() * shared;
      shared_score += weight * shared.transpose() * residual;
      const int unknown = UnknownOf(observation.frame);
      if (unknown < 0) continue;
      auto [block, fresh] = pose_point.try_emplace(unknown, PosePoint::Zero());
      block->second += weight * j.pose.transpose() * j.point;
      Block(unknown, unknown) += weight * j.pose.transpose() * j.pose;
      pose_shared_[unknown] += weight * j.pose.transpose() * shared;
      pose_score.try_emplace(unknown, Vector6d::Zero()).first->second +=
          weight * j.pose.transpose() * residual;
    }
    for (const auto& [unknown, score] : pose_score) pose_gradient_[unknown] += score;
    shared_gradient_ += shared_score;
    const Eigen::Vector3d point_step = v.inverse() * v_gradient;
    AddCluster(pose_score, pose_point, point_step, shared_score - shared_point * point_step);
    Eliminate(v, v_gradient, shared_point, pose_point);
  }

  CameraSystemResult Solve(const std::vector<std::optional<Rigid3>>& poses);
  // How the pose of each frame follows the calibration, once that was solved.
  const std::vector<PoseResponse>& responses() const { return responses_; }

 private:
  static constexpr int kFixed = -2;

  int UnknownOf(int frame) {
    int& unknown = unknown_[frame];
    if (unknown == -1) {
      unknown = static_cast<int>(pose_shared_.size());
      pose_shared_.push_back(PoseShared::Zero());
      pose_gradient_.push_back(Vector6d::Zero());
    }
    return unknown;
  }

  Matrix6d& Block(int row, int column) {
    return blocks_.try_emplace({row, column}, Matrix6d::Zero()).first->second;
  }

  // A track is a cluster: all its positions are aligned with one patch, or with each other's.
  void AddCluster(const std::map<int, Vector6d>& pose_score,
                  const std::map<int, PosePoint>& pose_point, const Eigen::Vector3d& point_step,
                  const CalibrationVector& shared_score) {
    if (!point_step.allFinite()) return;
    std::vector<ScoreClusters::Score> scores;
    for (const auto& [unknown, score] : pose_score) {
      scores.emplace_back(unknown, score - pose_point.at(unknown) * point_step);
    }
    clusters_.Add(std::move(scores), shared_score);
  }

  // Subtracts what the point's own freedom takes away.
  void Eliminate(const Eigen::Matrix3d& v, const Eigen::Vector3d& v_gradient,
                 const SharedPoint& shared_point, const std::map<int, PosePoint>& pose_point) {
    const Eigen::Matrix3d inverse = v.inverse();
    if (!inverse.allFinite()) return;
    for (const auto& [i, of_i] : pose_point) {
      const PosePoint scaled = of_i * inverse;
      for (const auto& [k, of_k] : pose_point) {
        if (k <= i) Block(i, k) -= scaled * of_k.transpose();
      }
      pose_shared_[i] -= scaled * shared_point.transpose();
      pose_gradient_[i] -= scaled * v_gradient;
    }
    shared_ -= shared_point * inverse * shared_point.transpose();
    shared_gradient_ -= shared_point * inverse * v_gradient;
  }

  // Share of the coordinates' freedom that the unknowns leave.
  double Redundancy() const {
    const double unknowns = point_unknowns_ + 6.0 * static_cast<double>(pose_shared_.size());
    return std::max(0.1, 1.0 - unknowns / std::max(coordinates_, 1.0));
  }

  // Whether others hang on the datum frame.
  bool IsNeeded(std::size_t datum_frame) const {
    for (std::size_t frame = 0; frame < datum_frames_.size(); ++frame) {
      if (frame != datum_frame && datum_frames_[frame] == static_cast<int>(datum_frame))
        return true;
    }
    return false;
  }

  std::vector<Vector6d> Inflations(const Factor& factor, const std::vector<Matrix6d>& inverse,
                                   const std::vector<std::optional<Rigid3>>& poses) const;

  void SolveCalibration(const Factor& factor, const std::vector<std::optional<Rigid3>>& poses,
                        CameraSystemResult& result);
  void SolveScale(const Factor& factor, const std::vector<std::optional<Rigid3>>& poses,
                  CameraSystemResult& result) const;

  std::vector<PoseResponse> responses_;
  std::vector<int> datum_frames_;
  std::vector<int> unknown_;
  ScoreClusters clusters_;
  double coordinates_ = 0.0, point_unknowns_ = 0.0;
  std::map<std::pair<int, int>, Matrix6d> blocks_;  // lower triangle
  std::vector<PoseShared> pose_shared_;
  std::vector<Vector6d> pose_gradient_;
  CalibrationMatrix shared_ = CalibrationMatrix::Zero();
  CalibrationVector shared_gradient_ = CalibrationVector::Zero();
};

Eigen::SparseMatrix<double> LowerTriangle(const std::map<std::pair<int, int>, Matrix6d>& blocks,
                                          int unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [at, block] : blocks) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) {
        const int row = 6 * at.first + r, column = 6 * at.second + c;
        if (column <= row) entries.emplace_back(row, column, block(r, c));
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(6 * unknowns, 6 * unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// From a perturbation of left_from_world (rotation, translation) to one of world_from_left
// (translation, rotation), in world axes.
Matrix6d WorldFromPerturbation(const Rigid3& left_from_world) {
  const Eigen::Matrix3d back = left_from_world.rotation.toRotationMatrix().transpose();
  Matrix6d jacobian;
  jacobian << -back * Skew(left_from_world.translation), -back, -back, Eigen::Matrix3d::Zero();
  return jacobian;
}

// In left camera axes.
Matrix6d LeftFromPerturbation(const Rigid3& left_from_world) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = left_from_world.rotation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  return turn * WorldFromPerturbation(left_from_world);
}

// Worked out for up to kProbes frames spread over the part, so that time stays linear in its
// length; the others take the last one's.
std::vector<Vector6d> ReducedSystem::Inflations(
    const Factor& factor, const std::vector<Matrix6d>& inverse,
    const std::vector<std::optional<Rigid3>>& poses) const {
  constexpr int kProbes = 60;
  const int unknowns = static_cast<int>(inverse.size()),
            stride = (unknowns + kProbes - 1) / kProbes;
  std::vector<Vector6d> inflations(poses.size(), Vector6d::Ones());
  Vector6d inflation = Vector6d::Ones();
  int met = 0;
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const int unknown = unknown_[frame];
    if (unknown < 0) continue;
    if (met++ % stride == 0) {
      Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6 * unknowns, 6);
      unit.middleRows<6>(6 * unknown).setIdentity();
      const Matrix6d jacobian = LeftFromPerturbation(*poses[frame]);
      const Matrix6d assumed = jacobian * inverse[unknown] * jacobian.transpose(),
                     found = jacobian * clusters_.Covariance(factor.solve(unit)) *
                             jacobian.transpose() / Redundancy();
      inflation = (found.diagonal().array() / assumed.diagonal().array()).sqrt().max(1.0);
      if (!inflation.allFinite()) inflation.setOnes();
    }
    inflations[frame] = inflation;
  }
  return inflations;
}

CameraSystemResult ReducedSystem::Solve(const std::vector<std::optional<Rigid3>>& poses) {
  CameraSystemResult result;
  result.datum_frames = datum_frames_;
  result.covariances.assign(poses.size(), Matrix6d::Zero());
  result.inflations.assign(poses.size(), Vector6d::Ones());
  const int unknowns = static_cast<int>(pose_shared_.size());
  if (unknowns == 0) return result;
  const Factor solver(LowerTriangle(blocks_, unknowns));
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) {
    for (std::size_t frame = 0; frame < poses.size(); ++frame) {
      if (unknown_[frame] >= 0) result.covariances[frame].diagonal().setConstant(kUnknownVariance);
    }
    return result;
  }
  const std::vector<Matrix6d> inverse = InverseDiagonalBlocks(solver);
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (unknown_[frame] < 0) continue;
    const Matrix6d jacobian = WorldFromPerturbation(*poses[frame]);
    result.covariances[frame] = jacobian * inverse[unknown_[frame]] * jacobian.transpose();
  }
  result.inflations = Inflations(solver, inverse, poses);
  SolveCalibration(solver, poses, result);
  SolveScale(solver, poses, result);
  return result;
}

// The system bordered by the calibration.
void ReducedSystem::SolveCalibration(const Factor& factor,
                                     const std::vector<std::optional<Rigid3>>& poses,
                                     CameraSystemResult& result) {
  const int unknowns = static_cast<int>(pose_shared_.size());
  Eigen::MatrixXd coupling(6 * unknowns, kShared);
  Eigen::VectorXd gradient(6 * unknowns);
  for (int i = 0; i < unknowns; ++i) {
    coupling.middleRows<6>(6 * i) = pose_shared_[i];
    gradient.segment<6>(6 * i) = pose_gradient_[i];
  }
  const Eigen::MatrixXd solved = factor.solve(coupling);
  const Eigen::VectorXd step = -factor.solve(gradient);
  CalibrationEquations equations;
  equations.information = shared_ - coupling.transpose() * solved;
  equations.score = -(shared_gradient_ - solved.transpose() * gradient);
  equations.score_covariance = clusters_.CalibrationCovariance(solved) / Redundancy();
  if (!RotationAndFocalStep(equations)) return;
  result.calibration = equations;
  result.by_calibration.assign(poses.size(), PoseShared::Zero());
  responses_.assign(poses.size(), {});
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (unknown_[frame] < 0) continue;
    responses_[frame] = {step.segment<6>(6 * unknown_[frame]),
                         -solved.middleRows<6>(6 * unknown_[frame])};
    result.by_calibration[frame] =
        WorldFromPerturbation(*poses[frame]) * responses_[frame].by_calibration;
  }
}

// Least squares of the scale between positions p and p + dp: the sum of w dp, w = (p - mean) / sum
// of squares.
void ReducedSystem::SolveScale(const Factor& factor,
                               const std::vector<std::optional<Rigid3>>& poses,
                               CameraSystemResult& result) const {
  if (!result.calibration) return;
  std::vector<std::size_t> frames;
  int datum_frames = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const bool is_used = unknown_[frame] >= 0;
    const bool is_datum = unknown_[frame] == kFixed && poses[frame] && IsNeeded(frame);
    if (is_datum) ++datum_frames;
    if (!is_used && !is_datum) continue;
    frames.push_back(frame);
    mean += poses[frame]->Inverse().translation;
  }
  if (datum_frames != 1) return;
  mean /= static_cast<double>(frames.size());
  double squares = 0.0;
  Eigen::MatrixXd functional = Eigen::MatrixXd::Zero(6 * static_cast<int>(pose_shared_.size()), 6);
  ScaleKnowledge scale;
  for (const std::size_t frame : frames) {
    const Eigen::Vector3d arm = poses[frame]->Inverse().translation - mean;
    squares += arm.squaredNorm();
    if (unknown_[frame] < 0) continue;
    functional.block<6, 1>(6 * unknown_[frame], 0) =
        WorldFromPerturbation(*poses[frame]).topRows<3>().transpose() * arm;
    scale.by_calibration += result.by_calibration[frame].topRows<3>().transpose() * arm;
  }
  if (!(squares > 0.0)) return;
  functional /= squares;
  scale.by_calibration /= squares;
  const Eigen::MatrixXd solved = factor.solve(functional);
  scale.variance = std::max(functional.col(0).dot(solved.col(0)),
                            clusters_.Covariance(solved)(0, 0) / Redundancy());
  result.scale = scale;
}

}  // namespace

CameraSystemResult SolveCameraSystem(const std::vector<AdjustedPoint>& points,
                                     const std::vector<std::optional<Rigid3>>& left_from_world,
                                     const StereoRig& rig, double noise_px, double huber_px) {
  ReducedSystem system(DatumFrames(points, left_from_world.size()));
  for (const AdjustedPoint& point : points) {
    system.AddPoint(point, left_from_world, rig, noise_px, huber_px);
  }
  CameraSystemResult result = system.Solve(left_from_world);
  if (result.calibration) {
    result.calibration->blocks =
        CalibrationBlocks(points, left_from_world, rig, system.responses(), noise_px, huber_px);
  }
  return result;
}

}  // namespace rigmap
