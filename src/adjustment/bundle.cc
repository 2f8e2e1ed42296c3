#include "adjustment/internal/bundle.h"

#include <ceres/ceres.h>
#include <glog/logging.h>
#include <spdlog/spdlog.h>

#include <limits>

#include "adjustment/internal/adjusted_points.h"
#include "adjustment/internal/datum_frames.h"
#include "adjustment/internal/reprojection_cost.h"
#include "adjustment/reprojection.h"

namespace rigmap {
namespace {

ceres::Problem::Options BorrowingOptions() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

class BundleProblem {
 public:
  BundleProblem(Bundle& bundle, double huber_px)
      : bundle_(bundle),
        loss_(huber_px),
        problem_(BorrowingOptions()),
        ordering_(std::make_shared<ceres::ParameterBlockOrdering>()) {
    for (const auto& pose : bundle.left_from_world) {
      frames_.push_back(ToBlock(pose.value_or(Rigid3())));
    }
    AddPoints();
    AddFrames();
  }

  void Solve(double function_tolerance) {
    constexpr int kMaxIterations = 50;  // a bound, should the tolerance not be reached
    ceres::Solver::Options solver_options;
    solver_options.linear_solver_type = ceres::SPARSE_SCHUR;
    solver_options.linear_solver_ordering = ordering_;
    solver_options.max_num_iterations = kMaxIterations;
    solver_options.function_tolerance = function_tolerance;
    // Nearly undamped from the start: the starting poses are good to a pixel, and damping would let
    // the bending of a long path, which hardly shows in the cost, converge slowly.
    solver_options.initial_trust_region_radius = 1e8;
    solver_options.num_threads = 1;  // the order of sums, and so the last digits, depends on it
    solver_options.logging_type = ceres::SILENT;
    // A step that fails is damped and tried again: no warning for our users' stderr.
    FLAGS_minloglevel = google::GLOG_ERROR;
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options, &problem_, &summary);
    spdlog::info("{}", summary.BriefReport());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      auto& pose = bundle_.left_from_world[i];
      if (pose) pose = FromBlock(frames_[i].data());
    }
  }

 private:
  void AddPoints() {
    for (AdjustedPoint& point : bundle_.points) {
      for (const PointObservation& observation : point.observations) {
        problem_.AddResidualBlock(MakeReprojectionCost(bundle_.rig, observation).release(), &loss_,
                                  frames_[observation.frame].data(), point.x.data());
      }
      ordering_->AddElementToGroup(point.x.data(), 0);
    }
  }

  void AddFrames() {
    const std::vector<int> datum_frames = DatumFrames(bundle_.points, frames_.size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      double* frame = frames_[i].data();
      if (!problem_.HasParameterBlock(frame)) continue;
      problem_.SetManifold(frame, frame_manifold_.get());
      ordering_->AddElementToGroup(frame, 1);
      if (datum_frames[i] == static_cast<int>(i)) problem_.SetParameterBlockConstant(frame);
    }
  }

  Bundle& bundle_;
  ceres::HuberLoss loss_;
  std::unique_ptr<ceres::Manifold> frame_manifold_ = MakeFrameManifold();
  std::vector<MotionBlock> frames_;
  ceres::Problem problem_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
};

}  // namespace

void SolveBundle(double huber_px, double function_tolerance, Bundle& bundle) {
  BundleProblem(bundle, huber_px).Solve(function_tolerance);
}

std::vector<double> ErrorsPx(const Bundle& bundle) {
  std::vector<double> errors;
  for (const AdjustedPoint& point : bundle.points) {
    for (const PointObservation& o : point.observations) {
      const auto at = Reproject(bundle.rig, o.eye, *bundle.left_from_world[o.frame], point.x);
      errors.push_back(at ? (at->pixel - o.pixel).norm() : std::numeric_limits<double>::infinity());
    }
  }
  return errors;
}

void DropBeyond(double limit_px, const std::vector<double>& errors_px, Bundle& bundle) {
  std::size_t next = 0;
  for (AdjustedPoint& point : bundle.points) {
    std::erase_if(point.observations,
                  [&](const PointObservation&) { return !(errors_px[next++] <= limit_px); });
  }
  std::erase_if(bundle.points, [](const AdjustedPoint& point) { return !SpansFrames(point); });
}

std::vector<int> ObservationsPerFrame(const Bundle& bundle) {
  std::vector<int> counts(bundle.left_from_world.size(), 0);
  for (const AdjustedPoint& point : bundle.points) {
    for (const PointObservation& observation : point.observations) ++counts[observation.frame];
  }
  return counts;
}

}  // namespace rigmap
