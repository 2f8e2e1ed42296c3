#include "adjustment/adjust.h"

#include <ceres/ceres.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adjustment/reprojection.h"
#include "adjustment/reprojection_cost.h"
#include "correspondence/tracks.h"

namespace rigmap {
namespace {

constexpr int kMinFrameObservations = 10;

std::vector<double> ErrorsPx(const std::vector<AdjustedPoint>& points,
                             const std::vector<std::optional<Rigid3>>& left_from_world,
                             const StereoRig& rig, const Rigid3& right_from_left) {
  std::vector<double> errors;
  for (const AdjustedPoint& point : points) {
    for (const PointObservation& o : point.observations) {
      const auto at = Reproject(rig, o.eye, right_from_left, *left_from_world[o.frame], point.x);
      errors.push_back(at ? (at->pixel - o.pixel).norm() : std::numeric_limits<double>::infinity());
    }
  }
  return errors;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Robust sigma of one coordinate from distances: the median of a Rayleigh distribution is 1.1774
// of its sigma. Most observations have fewer degrees of freedom than coordinates, so that
// residuals fall short of the noise; the redundancy mends that.
double NoisePx(const std::vector<double>& errors_px, double redundancy, double floor_px) {
  constexpr double kRayleighMedian = 1.1774;
  return std::max(floor_px,
                  Median(errors_px) / kRayleighMedian / std::sqrt(std::max(redundancy, 0.1)));
}

class Adjuster {
 public:
  Adjuster(const AdjustmentInput& input, const AdjustmentOptions& options)
      : input_(input), options_(options) {
    for (const auto& pose : input.world_from_left) {
      left_from_world_.push_back(pose ? std::optional(pose->Inverse()) : std::nullopt);
    }
    right_from_left_ = input.rig.right_from_left;
    // Wide at first: the starting poses are off by more than the pixels are.
    constexpr double kStartErrorPx = 8.0;
    points_ = TriangulateTracks(BuildTracks(input.correspondences, false), input.correspondences,
                                input.rig, left_from_world_, kStartErrorPx,
                                options.max_depth_baselines * input.rig.Baseline());
    input_observations_ = ObservationCount();
    noise_px_ = 1.0;
    DropThinFrames();
  }

  Adjustment Run() {
    for (int round = 0; round < options_.rounds && !points_.empty(); ++round) {
      Solve();
      const auto errors = ErrorsPx(points_, left_from_world_, input_.rig, right_from_left_);
      noise_px_ = NoisePx(errors, Redundancy(), options_.min_noise_px);
      const std::size_t before = ObservationCount();
      Cull(errors);
      DropThinFrames();
      spdlog::info("round {}: noise {:.3f} px, {} points, {} of {} observations dropped", round,
                   noise_px_, points_.size(), before - ObservationCount(), before);
    }
    return Result();
  }

 private:
  std::size_t ObservationCount() const {
    std::size_t count = 0;
    for (const AdjustedPoint& point : points_) count += point.observations.size();
    return count;
  }

  double Redundancy() const {
    const double coordinates = 2.0 * static_cast<double>(ObservationCount());
    const double unknowns = 3.0 * static_cast<double>(points_.size()) +
                            6.0 * static_cast<double>(left_from_world_.size());
    return 1.0 - unknowns / std::max(coordinates, 1.0);
  }

  void Solve() {
    std::vector<MotionBlock> frames;
    for (const auto& pose : left_from_world_) frames.push_back(ToBlock(pose.value_or(Rigid3())));
    MotionBlock rig_block = ToBlock(right_from_left_);
    const auto frame_manifold = MakeFrameManifold(), rig_manifold = MakeRigManifold();
    ceres::HuberLoss loss(options_.huber_sigmas * noise_px_);
    ceres::Problem::Options problem_options;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (AdjustedPoint& point : points_) {
      for (const PointObservation& observation : point.observations) {
        problem.AddResidualBlock(MakeReprojectionCost(input_.rig, observation).release(), &loss,
                                 frames[observation.frame].data(), point.x.data(),
                                 rig_block.data());
      }
      ordering->AddElementToGroup(point.x.data(), 0);
    }
    bool held = false;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (!problem.HasParameterBlock(frames[i].data())) continue;
      problem.SetManifold(frames[i].data(), frame_manifold.get());
      ordering->AddElementToGroup(frames[i].data(), 1);
      if (!std::exchange(held, true)) problem.SetParameterBlockConstant(frames[i].data());
    }
    problem.SetManifold(rig_block.data(), rig_manifold.get());
    ordering->AddElementToGroup(rig_block.data(), 1);
    if (options_.refine_rig == "none") {
      problem.SetParameterBlockConstant(rig_block.data());
    } else {
      const double sigma_rad = options_.rig_prior_deg * std::numbers::pi / 180.0;
      // Residuals of the images are in pixels, not sigmas.
      problem.AddResidualBlock(
          MakeRigPrior(input_.rig.right_from_left, sigma_rad / noise_px_).release(), nullptr,
          rig_block.data());
    }
    ceres::Solver::Options solver_options;
    solver_options.linear_solver_type = ceres::SPARSE_SCHUR;
    solver_options.linear_solver_ordering = ordering;
    solver_options.max_num_iterations = options_.max_iterations;
    solver_options.function_tolerance = options_.function_tolerance;
    solver_options.num_threads = 1;  // the order of sums, and so the last digits, depends on it
    solver_options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options, &problem, &summary);
    spdlog::info("{}", summary.BriefReport());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (left_from_world_[i]) left_from_world_[i] = FromBlock(frames[i].data());
    }
    right_from_left_ = FromBlock(rig_block.data());
  }

  // Drops observations beyond the limit, then points that fewer than two frames still show.
  void Cull(const std::vector<double>& errors_px) {
    const double limit_px = options_.outlier_sigmas * noise_px_;
    std::size_t next = 0;
    for (AdjustedPoint& point : points_) {
      std::erase_if(point.observations,
                    [&](const PointObservation&) { return !(errors_px[next++] <= limit_px); });
    }
    std::erase_if(points_, [](const AdjustedPoint& point) {
      return point.observations.empty() ||
             point.observations.front().frame == point.observations.back().frame;
    });
  }

  // A frame with hardly an observation would float; its observations go with it.
  void DropThinFrames() {
    const std::vector<int> counts = ObservationsPerFrame();
    const auto is_thin = [&](int frame) { return counts[frame] < kMinFrameObservations; };
    for (AdjustedPoint& point : points_) {
      std::erase_if(point.observations, [&](const auto& o) { return is_thin(o.frame); });
    }
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (is_thin(static_cast<int>(i))) left_from_world_[i].reset();
    }
    std::erase_if(points_, [](const AdjustedPoint& p) { return p.observations.size() < 2; });
  }

  std::vector<int> ObservationsPerFrame() const {
    std::vector<int> counts(left_from_world_.size(), 0);
    for (const AdjustedPoint& point : points_) {
      for (const PointObservation& observation : point.observations) ++counts[observation.frame];
    }
    return counts;
  }

  Adjustment Result() {
    Adjustment result;
    result.observation_counts = ObservationsPerFrame();
    const auto errors = ErrorsPx(points_, left_from_world_, input_.rig, right_from_left_);
    result.reprojection_px = Median(errors);
    result.noise_px = noise_px_;
    result.outlier_share =
        1.0 - static_cast<double>(errors.size()) /
                  std::max<double>(1.0, static_cast<double>(input_observations_));
    StereoRig rig = input_.rig;
    rig.right_from_left = right_from_left_;
    CameraSystemResult system = SolveCameraSystem(points_, left_from_world_, rig, noise_px_,
                                                  options_.huber_sigmas * noise_px_);
    result.covariances = std::move(system.covariances);
    result.calibration = system.calibration;
    result.right_from_left = right_from_left_;
    for (const auto& pose : left_from_world_) {
      result.world_from_left.push_back(pose ? std::optional(pose->Inverse()) : std::nullopt);
    }
    result.points = std::move(points_);
    return result;
  }

  const AdjustmentInput& input_;
  const AdjustmentOptions& options_;
  std::vector<std::optional<Rigid3>> left_from_world_;
  Rigid3 right_from_left_;
  std::vector<AdjustedPoint> points_;
  std::size_t input_observations_ = 0;
  double noise_px_ = 1.0;
};

}  // namespace

Adjustment AdjustBundle(const AdjustmentInput& input, const AdjustmentOptions& options) {
  return Adjuster(input, options).Run();
}

}  // namespace rigmap
