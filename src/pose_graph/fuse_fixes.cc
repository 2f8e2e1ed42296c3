#include "pose_graph/fuse_fixes.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/statistics.h"
#include "geometry/motion_block.h"
#include "pose_graph/internal/fix_errors.h"
#include "pose_graph/internal/step_noise.h"

namespace rigmap {
namespace {

constexpr double kCauchySigmas = 2.0;
// Of three numbers together; as rarely exceeded by noise, once in 16 000 fixes, as four of one.
constexpr double kOutlierSigmas = 4.70;
constexpr std::size_t kMinFixes = 4;
constexpr int kMostRounds = 5;  // of leaving out what does not agree
constexpr double kMinBelieved = 2.0 / 3.0;
// Of the world's up axis, which accelerometers or the ground told.
constexpr double kUpSigma_rad = 0.02;

double SecondsSinceFirst(const Trajectory& poses, std::size_t i) {
  return 1e-9 * static_cast<double>(poses[i].stamp_ns - poses.front().stamp_ns);
}

// The pose before a time and how far it is to the next one.
struct Between {
  std::size_t before = 0;
  double share = 0.0;
};

std::optional<Between> Find(const Trajectory& poses, double time_s, double max_gap_s) {
  if (poses.size() < 2) return std::nullopt;
  if (time_s < 0.0 || time_s > SecondsSinceFirst(poses, poses.size() - 1)) return std::nullopt;
  const auto seconds = [&](const TimedPose& pose) {
    return 1e-9 * static_cast<double>(pose.stamp_ns - poses.front().stamp_ns);
  };
  const auto end =
      std::ranges::lower_bound(poses.begin() + 1, poses.end() - 1, time_s, {}, seconds);
  const auto after = static_cast<std::size_t>(end - poses.begin());
  const double from_s = SecondsSinceFirst(poses, after - 1), to_s = SecondsSinceFirst(poses, after);
  if (to_s - from_s > max_gap_s) return std::nullopt;
  if (!poses[after - 1].IsMeasured() || !poses[after].IsMeasured()) return std::nullopt;
  return Between{after - 1, (time_s - from_s) / (to_s - from_s)};
}

class FixFuser {
 public:
  FixFuser(const Trajectory& poses, const std::vector<AntennaFix>& fixes, const FixFusion& fusion)
      : poses_(poses),
        fixes_(fixes),
        fusion_(fusion),
        noise_(NoisePerStep(poses, fusion.step_covariances, fusion.scale_sigma)),
        used_(fixes.size(), 0) {
    for (const TimedPose& pose : poses) blocks_.push_back(ToBlock(pose.world_from_left));
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      spans_.push_back(Find(poses, fixes[i].time_s, fusion.max_gap_s));
      used_[i] = spans_.back() ? 1 : 0;
    }
  }

  std::optional<FusedFixes> Fuse() {
    const auto there = static_cast<std::size_t>(std::ranges::count(used_, 1));
    if (there < kMinFixes) return std::nullopt;
    if (!Solve(true)) return std::nullopt;
    RaiseSigmas();
    if (!Solve(true)) return std::nullopt;
    std::optional<double> cost;
    std::size_t believed = 0;
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<char> agree = ThoseThatAgree();
      if (cost && agree == used_) break;
      used_ = std::move(agree);
      believed = static_cast<std::size_t>(std::ranges::count(used_, 1));
      if (believed < kMinFixes ||
          static_cast<double>(believed) < kMinBelieved * static_cast<double>(there)) {
        return std::nullopt;
      }
      cost = Solve(false);
      if (!cost) return std::nullopt;
    }
    return Result(*cost, believed);
  }

 private:
  // Half the sum of squares; nothing where the search does not settle.
  std::optional<double> Solve(bool robust) {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(options);
    ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> motion;
    for (auto& block : blocks_) problem.AddParameterBlock(block.data(), 7, &motion);
    problem.SetParameterBlockConstant(blocks_[FirstMeasured(poses_)].data());
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const Rigid3 step = poses_[i - 1].world_from_left.Inverse() * poses_[i].world_from_left;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<StepError, 6, 7, 7, 1>(new StepError{step, noise_[i]}),
          nullptr, blocks_[i - 1].data(), blocks_[i].data(), &scale_);
    }
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      if (used_[i]) AddFix(i, robust, problem);
    }
    AddPriors(problem);
    ceres::Solver::Options how;
    how.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    how.num_threads = 1;
    how.max_num_iterations = 100;
    how.function_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    ceres::Solve(how, &problem, &summary);
    if (summary.termination_type != ceres::CONVERGENCE) return std::nullopt;
    return summary.final_cost;
  }

  FixError ErrorOf(std::size_t i) const {
    const auto [before, share] = *spans_[i];
    const Rigid3 &from = poses_[before].world_from_left, &to = poses_[before + 1].world_from_left;
    const double seconds =
        SecondsSinceFirst(poses_, before + 1) - SecondsSinceFirst(poses_, before);
    const Eigen::Vector3d velocity =
        (to * fusion_.antenna_in_left - from * fusion_.antenna_in_left) / seconds;
    return {fixes_[i],    share, velocity, fusion_.antenna_in_left, fusion_.enu_from_world,
            sigma_factor_};
  }

  void AddFix(std::size_t i, bool robust, ceres::Problem& problem) {
    const std::size_t before = spans_[i]->before;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<FixError, 3, 7, 7, 6, 1>(new FixError(ErrorOf(i))),
        robust ? new ceres::CauchyLoss(kCauchySigmas) : nullptr, blocks_[before].data(),
        blocks_[before + 1].data(), frame_.data(), &clock_s_);
  }

  void AddPriors(ceres::Problem& problem) {
    using ScalePrior = Prior<1>;
    using One = Eigen::Matrix<double, 1, 1>;
    problem.AddParameterBlock(&scale_, 1);
    if (fusion_.scale_sigma > 0.0) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalePrior, 1, 1>(new ScalePrior{
                                   One::Constant(1.0), One::Constant(fusion_.scale_sigma)}),
                               nullptr, &scale_);
    } else {
      problem.SetParameterBlockConstant(&scale_);
    }
    if (fusion_.clock_sigma_s) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalePrior, 1, 1>(new ScalePrior{
                                   One::Zero(), One::Constant(*fusion_.clock_sigma_s)}),
                               nullptr, &clock_s_);
    } else {
      problem.SetParameterBlockConstant(&clock_s_);
    }
    // Only the inclination of the world is known beforehand.
    Eigen::Matrix<double, 6, 1> sigma;
    constexpr double kUnknown = 1e4;
    sigma << kUpSigma_rad, kUpSigma_rad, kUnknown, kUnknown, kUnknown, kUnknown;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior<6>, 6, 6>(
                                 new Prior<6>{Eigen::Matrix<double, 6, 1>::Zero(), sigma}),
                             nullptr, frame_.data());
  }

  // Length of a fix's error, each coordinate in its own sigmas.
  double Distance(std::size_t i) const {
    const std::size_t before = spans_[i]->before;
    std::array<double, 3> residual{};
    ErrorOf(i)(blocks_[before].data(), blocks_[before + 1].data(), frame_.data(), &clock_s_,
               residual.data());
    return std::hypot(residual[0], residual[1], residual[2]);
  }

  // Receivers state what their own filter believes, which may be too little.
  void RaiseSigmas() {
    constexpr double kMedianOfThree = 1.538;  // of the length of three unit normals
    std::vector<double> distances;
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      if (used_[i]) distances.push_back(Distance(i));
    }
    sigma_factor_ = std::max(1.0, Median(std::move(distances)) / kMedianOfThree);
  }

  // By what was solved last: where the clock was off, good fixes were far off, too.
  std::vector<char> ThoseThatAgree() const {
    std::vector<char> agree(fixes_.size(), 0);
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      agree[i] = spans_[i] && Distance(i) <= kOutlierSigmas;
    }
    return agree;
  }

  FusedFixes Result(double cost, std::size_t believed) const {
    FusedFixes result;
    for (const auto& block : blocks_) result.world_from_left.push_back(FromBlock(block.data()));
    const Rigid3 correction{ToRotation(frame_.data()),
                            Eigen::Vector3d(frame_[3], frame_[4], frame_[5])};
    result.enu_from_world = correction * fusion_.enu_from_world;
    result.scale = scale_;
    result.clock_offset_s = clock_s_;
    result.used = used_;
    result.chi2 = 2.0 * cost;
    // Steps and their poses cancel, and so do the priors; heading and origin have none.
    result.degrees_of_freedom = static_cast<int>(3 * believed) - 4;
    result.fix_noise_factor = sigma_factor_;
    double of_fixes = 0.0;
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      if (used_[i]) of_fixes += Distance(i) * Distance(i);
    }
    result.chi2_as_stated = result.chi2 + (sigma_factor_ * sigma_factor_ - 1.0) * of_fixes;
    return result;
  }

  const Trajectory& poses_;
  const std::vector<AntennaFix>& fixes_;
  const FixFusion& fusion_;
  std::vector<StepNoise> noise_;               // of the step to each pose
  std::vector<std::optional<Between>> spans_;  // of each fix among the poses
  std::vector<char> used_;
  std::vector<MotionBlock> blocks_;
  std::array<double, 6> frame_{};
  double scale_ = 1.0, clock_s_ = 0.0, sigma_factor_ = 1.0;
};

}  // namespace

std::optional<FusedFixes> FuseFixes(const Trajectory& poses, const std::vector<AntennaFix>& fixes,
                                    const FixFusion& fusion) {
  if (poses.size() < 2) return std::nullopt;
  return FixFuser(poses, fixes, fusion).Fuse();
}

std::optional<Eigen::Vector3d> AntennaAt(const Trajectory& poses, double time_s,
                                         const Eigen::Vector3d& antenna_in_left, double max_gap_s) {
  if (poses.size() < 2) return std::nullopt;
  const auto found = Find(poses, time_s, max_gap_s);
  if (!found) return std::nullopt;
  return Eigen::Vector3d(
      (1.0 - found->share) * (poses[found->before].world_from_left * antenna_in_left) +
      found->share * (poses[found->before + 1].world_from_left * antenna_in_left));
}

}  // namespace rigmap
