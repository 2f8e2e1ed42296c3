#include "adjustment/internal/camera_system.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <functional>
#include <map>
#include <memory>

#include "adjustment/internal/selected_inverse.h"
#include "geometry/carried_covariance.h"

namespace rigmap {
namespace {

constexpr double kUnknownVariance = 1e6;
using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
using Poses = std::vector<std::optional<Rigid3>>;

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
std::vector<Vector6d> Inflations(const ReducedSystem& system, const Factor& factor,
                                 const SelectedInverse& inverse, const Poses& poses) {
  constexpr int kProbes = 60;
  std::vector<std::size_t> frames;  // of which the pose is unknown
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (system.IsUnknown(frame)) frames.push_back(frame);
  }
  const std::size_t stride = std::max<std::size_t>(1, (frames.size() + kProbes - 1) / kProbes);
  const std::size_t probes = (frames.size() + stride - 1) / stride;
  std::vector<Vector6d> probed(probes);
  tbb::parallel_for(std::size_t{0}, probes, [&](std::size_t probe) {
    const std::size_t frame = frames[probe * stride];
    const int unknown = system.unknown[frame];
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6 * system.unknowns, 6);
    unit.middleRows<6>(6 * unknown).setIdentity();
    const Matrix6d jacobian = LeftFromPerturbation(*poses[frame]);
    const Matrix6d assumed = jacobian * inverse.Block(unknown, unknown) * jacobian.transpose(),
                   found = jacobian * system.clusters.Covariance(factor.solve(unit)) *
                           jacobian.transpose() / system.Redundancy();
    probed[probe] = (found.diagonal().array() / assumed.diagonal().array()).sqrt().max(1.0);
    if (!probed[probe].allFinite()) probed[probe].setOnes();
  });
  std::vector<Vector6d> inflations(poses.size(), Vector6d::Ones());
  for (std::size_t i = 0; i < frames.size(); ++i) inflations[frames[i]] = probed[i / stride];
  return inflations;
}

// Whether others hang on the datum frame.
bool IsNeeded(const ReducedSystem& system, std::size_t datum_frame) {
  for (std::size_t frame = 0; frame < system.datum_frames.size(); ++frame) {
    if (frame != datum_frame && system.datum_frames[frame] == static_cast<int>(datum_frame)) {
      return true;
    }
  }
  return false;
}

// Nothing where the system is singular.
std::unique_ptr<Factor> Factorised(const ReducedSystem& system) {
  auto factor = std::make_unique<Factor>(LowerTriangle(system.blocks, system.unknowns));
  if (factor->info() != Eigen::Success || !(factor->vectorD().minCoeff() > 0.0)) return nullptr;
  return factor;
}

// Least squares of the scale between positions p and p + dp: the sum of w dp, w = (p - mean) / sum
// of squares.
std::optional<ScaleKnowledge> SolveScale(const ReducedSystem& system, const Factor& factor,
                                         const Poses& poses,
                                         const std::optional<FieldSolution>& field,
                                         const CameraSystemResult& result) {
  std::vector<std::size_t> frames;
  int datum_frames = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const bool is_datum = system.datum_frames[frame] == static_cast<int>(frame) && poses[frame] &&
                          IsNeeded(system, frame);
    if (is_datum) ++datum_frames;
    if (!system.IsUnknown(frame) && !is_datum) continue;
    frames.push_back(frame);
    mean += poses[frame]->Inverse().translation;
  }
  if (datum_frames != 1) return std::nullopt;
  mean /= static_cast<double>(frames.size());
  double squares = 0.0;
  Eigen::MatrixXd functional = Eigen::MatrixXd::Zero(6 * system.unknowns, 6);
  ScaleKnowledge scale;
  for (const std::size_t frame : frames) {
    const Eigen::Vector3d arm = poses[frame]->Inverse().translation - mean;
    squares += arm.squaredNorm();
    if (!system.IsUnknown(frame)) continue;
    functional.block<6, 1>(6 * system.unknown[frame], 0) =
        WorldFromPerturbation(*poses[frame]).topRows<3>().transpose() * arm;
    scale.by_calibration += result.by_calibration[frame].topRows<3>().transpose() * arm;
  }
  if (!(squares > 0.0)) return std::nullopt;
  functional /= squares;
  scale.by_calibration /= squares;
  const Eigen::MatrixXd solved = factor.solve(functional);
  scale.variance = std::max(functional.col(0).dot(solved.col(0)),
                            system.clusters.Covariance(solved)(0, 0) / system.Redundancy());
  if (field) {
    scale.variance += (functional.col(0).transpose() * field->PoseSpread()).squaredNorm();
  }
  return scale;
}

// Of the poses of two frames together, in world axes; zero for those that are held.
class PoseCovariances {
 public:
  PoseCovariances(const ReducedSystem& system, const Factor& factor, const Poses& poses)
      : system_(system), factor_(factor), poses_(poses), inverse_(factor) {}

  const SelectedInverse& Inverse() const { return inverse_; }

  Matrix6d Of(std::size_t a, std::size_t b) const {
    if (!system_.IsUnknown(a) || !system_.IsUnknown(b)) return Matrix6d::Zero();
    return WorldFromPerturbation(*poses_[a]) * Block(system_.unknown[a], system_.unknown[b]) *
           WorldFromPerturbation(*poses_[b]).transpose();
  }

  Matrix6d OfMotion(std::size_t from, std::size_t to) const {
    const Matrix6d carry = CarryMatrix(poses_[from]->Inverse(), poses_[to]->Inverse());
    const Matrix6d shared = Of(to, from) * carry.transpose();
    return Of(to, to) - shared - shared.transpose() + carry * Of(from, from) * carry.transpose();
  }

 private:
  Matrix6d Block(int row, int column) const {
    if (system_.blocks.contains(std::minmax(row, column, std::greater()))) {
      return inverse_.Block(row, column);
    }
    // The two share no points.
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6 * system_.unknowns, 6);
    unit.middleRows<6>(6 * column).setIdentity();
    return factor_.solve(unit).middleRows<6>(6 * row);
  }

  const ReducedSystem& system_;
  const Factor& factor_;
  const Poses& poses_;
  SelectedInverse inverse_;
};

// Adds what is not known of the field.
void SpreadByField(const ReducedSystem& system, const FieldSolution& field, const Poses& poses,
                   const std::vector<int>& references, CameraSystemResult& result) {
  const Eigen::MatrixXd spread = field.PoseSpread();
  const auto of_frame = [&](std::size_t frame) -> Eigen::MatrixXd {
    if (!system.IsUnknown(frame)) return Eigen::MatrixXd::Zero(6, spread.cols());
    return WorldFromPerturbation(*poses[frame]) * spread.middleRows<6>(6 * system.unknown[frame]);
  };
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (!system.IsUnknown(frame)) continue;
    const Eigen::MatrixXd columns = of_frame(frame);
    result.covariances[frame] += columns * columns.transpose();
  }
  for (std::size_t frame = 0; frame < references.size(); ++frame) {
    if (!result.link_covariances[frame]) continue;
    const auto reference = static_cast<std::size_t>(references[frame]);
    const Matrix6d carry = CarryMatrix(poses[reference]->Inverse(), poses[frame]->Inverse());
    const Eigen::MatrixXd columns = of_frame(frame) - carry * of_frame(reference);
    *result.link_covariances[frame] += columns * columns.transpose();
  }
}

void SetCovariances(const ReducedSystem& system, const Factor& factor, const Poses& poses,
                    const std::vector<int>& references, CameraSystemResult& result) {
  const PoseCovariances covariances(system, factor, poses);
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (system.IsUnknown(frame)) result.covariances[frame] = covariances.Of(frame, frame);
  }
  result.inflations = Inflations(system, factor, covariances.Inverse(), poses);
  result.link_covariances.resize(poses.size());
  for (std::size_t frame = 0; frame < references.size(); ++frame) {
    const auto reference = static_cast<std::size_t>(references[frame]);
    if (reference == frame || !poses[frame] || !poses[reference] ||
        system.datum_frames[frame] != system.datum_frames[reference]) {
      continue;
    }
    result.link_covariances[frame] = covariances.OfMotion(reference, frame);
  }
}

}  // namespace

CameraSystemResult SolveCameraSystem(const Linearisation& at, const std::vector<int>& references) {
  const Poses& poses = at.left_from_world;
  const ReducedSystem system = AssembleReducedSystem(at);
  CameraSystemResult result;
  result.datum_frames = system.datum_frames;
  result.covariances.assign(poses.size(), Matrix6d::Zero());
  result.inflations.assign(poses.size(), Vector6d::Ones());
  if (system.unknowns == 0) return result;
  const auto factor = Factorised(system);
  if (!factor) {
    for (std::size_t frame = 0; frame < poses.size(); ++frame) {
      if (system.IsUnknown(frame))
        result.covariances[frame].diagonal().setConstant(kUnknownVariance);
    }
    return result;
  }
  SetCovariances(system, *factor, poses, references, result);
  auto solution = SolveBorder(system, at);
  if (!solution) return result;
  result.by_calibration.assign(poses.size(), PoseCalibration::Zero());
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    if (!system.IsUnknown(frame)) continue;
    result.by_calibration[frame] =
        WorldFromPerturbation(*poses[frame]) * solution->responses[frame].by_calibration;
  }
  result.calibration = std::move(solution->equations);
  if (solution->field) SpreadByField(system, *solution->field, poses, references, result);
  result.scale = SolveScale(system, *factor, poses, solution->field, result);
  return result;
}

}  // namespace rigmap
