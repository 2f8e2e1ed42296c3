#include "adjustment/internal/bundle_solver.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rigmap {
namespace {

// Relative to the diagonal. Nearly undamped from the start: the starting poses are good to a pixel,
// and damping would let the bending of a long path, which hardly shows in the cost, converge
// slowly.
constexpr double kStartDamping = 1e-8, kLeastDamping = 1e-16;

template <class Work>
void ForEach(std::size_t count, const Work& work) {
  tbb::parallel_for(std::size_t{0}, count, work);
}

double Loss(double squared, double huber) {
  return squared <= huber * huber ? squared : 2.0 * huber * std::sqrt(squared) - huber * huber;
}

// Beyond Huber's limit the loss does not bend along the residual. Weights alone (iterative
// reweighting) count it as if it did, and steps fall short; without any of it nothing would hold
// some points. Half of it saves a third of the iterations near the solution; far off, where most
// residuals are beyond the limit, steps would go astray.
void FlattenAlong(const Eigen::Vector2d& direction, FrameProjection::Linearised& at) {
  constexpr double kFlattened = 0.3;  // leaves half of the second derivative, (1 - 0.3)^2
  at.by_pose -= kFlattened * direction * (direction.transpose() * at.by_pose).eval();
  at.by_point -= kFlattened * direction * (direction.transpose() * at.by_point).eval();
}

}  // namespace

std::vector<FrameProjection> BundleSolver::Projections(const std::vector<Rigid3>& poses) const {
  std::vector<FrameProjection> projections;
  for (const Rigid3& pose : poses) projections.emplace_back(bundle_.rig, pose);
  return projections;
}

double BundleSolver::Cost(const std::vector<Rigid3>& poses,
                          const std::vector<Eigen::Vector3d>& points) const {
  const std::vector<FrameProjection> frames = Projections(poses);
  std::vector<double> costs(parts_.size(), 0.0);
  ForEach(parts_.size(), [&](std::size_t i) {
    for (std::size_t p = parts_[i].begin; p < parts_[i].end; ++p) {
      for (const PointObservation& o : bundle_.points[p].observations) {
        const auto pixel = frames[o.frame].Project(o.eye, points[p]);
        costs[i] += pixel ? 0.5 * Loss((*pixel - o.pixel).squaredNorm(), huber_px_)
                          : std::numeric_limits<double>::infinity();
      }
    }
  });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

BundleSolver::Sums::Sums(const Part& part)
    : blocks(part.pairs.size(), Matrix6d::Zero()),
      gradients(part.unknowns.size(), Vector6d::Zero()),
      diagonals(part.unknowns.size(), Vector6d::Zero()) {}

BundleSolver::Sums BundleSolver::Linearise(const Part& part,
                                           const std::vector<FrameProjection>& frames,
                                           double damping) {
  Sums sums(part);
  const int* first_pair = part.pair_of.data();
  for (std::size_t p = part.begin; p < part.end; ++p) {
    Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
    Eigen::Vector3d& gradient = eliminated_[p].gradient;
    gradient.setZero();
    std::size_t next = first_view_[p];
    int last_frame = -1;
    for (const PointObservation& o : bundle_.points[p].observations) {
      const bool is_unknown = unknown_[o.frame] >= 0;
      if (o.frame != last_frame && is_unknown) views_[next++].coupling.setZero();
      last_frame = o.frame;
      auto at = frames[o.frame].Linearise(o.eye, points_[p]);
      if (!at) continue;
      const Eigen::Vector2d residual = at->pixel - o.pixel;
      const double size = residual.norm(), weight = size > huber_px_ ? huber_px_ / size : 1.0;
      const Eigen::Vector2d pull = weight * residual;
      gradient += at->by_point.transpose() * pull;
      if (is_unknown) sums.gradients[views_[next - 1].local] += at->by_pose.transpose() * pull;
      if (weight < 1.0 && is_near_) FlattenAlong(residual / size, *at);
      v += weight * at->by_point.transpose() * at->by_point;
      if (!is_unknown) continue;
      View& view = views_[next - 1];
      const Eigen::Matrix<double, 6, 2> weighted = weight * at->by_pose.transpose();
      view.coupling += weighted * at->by_point;
      sums.diagonals[view.local] += weighted.cwiseProduct(at->by_pose.transpose()).rowwise().sum();
      const std::size_t a = next - 1 - first_view_[p];
      sums.blocks[first_pair[a * (a + 3) / 2]] += weighted * at->by_pose;
    }
    v.diagonal() *= 1.0 + damping;
    Eliminate(v, p, first_pair, sums);
    const std::size_t count = first_view_[p + 1] - first_view_[p];
    first_pair += count * (count + 1) / 2;
  }
  return sums;
}

// Takes off what the point's own freedom takes away. `pair` is that of its first view with itself.
void BundleSolver::Eliminate(const Eigen::Matrix3d& v, std::size_t point, const int* pair,
                             Sums& sums) {
  const Eigen::Vector3d& gradient = eliminated_[point].gradient;
  Eigen::Matrix3d& inverse = eliminated_[point].inverse;
  const Eigen::LLT<Eigen::Matrix3d> factor(v);
  inverse.setZero();
  if (factor.info() != Eigen::Success) return;  // held: nothing determines it
  inverse = factor.solve(Eigen::Matrix3d::Identity());
  sums.gain += gradient.dot(inverse * gradient);
  const View* views = views_.data() + first_view_[point];
  const std::size_t count = first_view_[point + 1] - first_view_[point];
  for (std::size_t a = 0; a < count; ++a) {
    const PosePoint scaled = views[a].coupling * inverse;
    sums.gradients[views[a].local] -= scaled * gradient;
    for (std::size_t b = 0; b <= a; ++b) {
      sums.blocks[*pair++].noalias() -= scaled * views[b].coupling.transpose();
    }
  }
}

void BundleSolver::Add(const Part& part, const Sums& sums, Total& total) {
  for (std::size_t i = 0; i < part.pairs.size(); ++i) blocks_[part.pairs[i]] += sums.blocks[i];
  for (std::size_t i = 0; i < part.unknowns.size(); ++i) {
    total.gradient.segment<6>(6 * part.unknowns[i]) += sums.gradients[i];
    total.diagonal.segment<6>(6 * part.unknowns[i]) += sums.diagonals[i];
  }
  total.gain += sums.gain;
}

// A batch of parts at a time: the sums of all of them would take as much room as the couplings.
BundleSolver::Total BundleSolver::Linearise(double damping) {
  constexpr std::size_t kBatch = 64;
  const std::vector<FrameProjection> frames = Projections(poses_);
  blocks_.assign(pairs_.size(), Matrix6d::Zero());
  Total total{Eigen::VectorXd::Zero(6 * unknowns_), Eigen::VectorXd::Zero(6 * unknowns_)};
  for (std::size_t first = 0; first < parts_.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, parts_.size() - first);
    std::vector<std::optional<Sums>> sums(count);
    ForEach(count, [&](std::size_t i) { sums[i] = Linearise(parts_[first + i], frames, damping); });
    for (std::size_t i = 0; i < count; ++i) Add(parts_[first + i], *sums[i], total);
  }
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& [column, row] = pairs_[i];
    if (column == row) blocks_[i].diagonal() += damping * total.diagonal.segment<6>(6 * row);
  }
  return total;
}

Eigen::Vector3d BundleSolver::MovePoint(std::size_t point, const Eigen::VectorXd& step) const {
  Eigen::Vector3d gradient = eliminated_[point].gradient;
  for (std::size_t v = first_view_[point]; v < first_view_[point + 1]; ++v) {
    gradient += views_[v].coupling.transpose() * step.segment<6>(6 * views_[v].unknown);
  }
  return points_[point] - eliminated_[point].inverse * gradient;
}

std::optional<BundleSolver::Step> BundleSolver::FindStep(double damping) {
  const Total total = Linearise(damping);
  const Eigen::VectorXd& gradient = total.gradient;
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(6 * unknowns_);
  if (unknowns_ > 0) {
    if (!matrix_->Factorise(blocks_)) return std::nullopt;
    moved = -matrix_->Solve(gradient);
  }
  if (!moved.allFinite()) return std::nullopt;
  Step step{poses_, points_, -0.5 * gradient.dot(moved) + 0.5 * total.gain};
  for (std::size_t frame = 0; frame < poses_.size(); ++frame) {
    if (unknown_[frame] < 0) continue;
    const Vector6d by = moved.segment<6>(6 * unknown_[frame]);
    Rigid3& pose = step.poses[frame];
    pose = {(ExpRotation(by.head<3>()) * pose.rotation).normalized(),
            pose.translation + by.tail<3>()};
  }
  ForEach(parts_.size(), [&](std::size_t i) {
    for (std::size_t p = parts_[i].begin; p < parts_[i].end; ++p) {
      step.points[p] = MovePoint(p, moved);
    }
  });
  return step;
}

BundleSolver::Summary BundleSolver::Solve(double function_tolerance) {
  constexpr int kMaxIterations = 50;    // a bound, should the tolerance not be reached
  constexpr double kLeastShare = 1e-3;  // of the expected gain
  constexpr double kNearShare = 0.1;   // a step that gained less of the cost ends near the solution
  constexpr double kRounding = 1e-20;  // of the initial cost: nothing is left to gain
  double cost = Cost(poses_, points_), damping = kStartDamping, raise = 2.0;
  Summary summary{.initial_cost = cost, .final_cost = cost};
  if (!std::isfinite(cost)) return summary;
  while (summary.iterations < kMaxIterations) {
    ++summary.iterations;
    std::optional<Step> step = FindStep(damping);
    const double gain = step ? cost - Cost(step->poses, step->points) : -1.0;
    if (!(step && gain > kLeastShare * step->expected_gain)) {
      // No step gains anything any more, but for rounding.
      summary.settled = step && step->expected_gain <= function_tolerance * cost;
      if (summary.settled) break;
      damping *= raise;
      raise *= 2.0;
      is_near_ = false;
      continue;
    }
    // Nielsen 1999, as in Ceres.
    const double share = 2.0 * gain / step->expected_gain - 1.0;
    damping = std::max(kLeastDamping, damping * std::max(1.0 / 3.0, 1.0 - share * share * share));
    raise = 2.0;
    poses_ = std::move(step->poses);
    points_ = std::move(step->points);
    cost -= gain;
    summary.settled = gain <= function_tolerance * cost || cost <= kRounding * summary.initial_cost;
    if (summary.settled) break;
    is_near_ = gain <= kNearShare * cost;
  }
  summary.final_cost = cost;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (unknown_[i] >= 0) bundle_.left_from_world[i] = poses_[i];
  }
  for (std::size_t p = 0; p < points_.size(); ++p) bundle_.points[p].x = points_[p];
  return summary;
}

}  // namespace rigmap
