#include "adjustment/adjust.h"

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "adjustment/calibration.h"
#include "adjustment/calibration_prior.h"
#include "adjustment/internal/adjusted_points.h"
#include "adjustment/internal/bundle.h"
#include "adjustment/internal/camera_system.h"
#include "adjustment/internal/datum_frames.h"
#include "adjustment/internal/drift_effect.h"
#include "adjustment/internal/lens_description.h"
#include "adjustment/internal/pose_sigmas.h"
#include "adjustment/internal/rig_flexure.h"
#include "core/statistics.h"
#include "correspondence/tracks.h"

namespace rigmap {
namespace {

class Adjuster {
 public:
  Adjuster(const AdjustmentInput& input, const AdjustmentOptions& options)
      : input_(input),
        options_(options),
        tracks_(CutTracks(BuildTracks(input.correspondences, false), input.apart)),
        bundle_{.rig = Corrected(input.rig, input.correction)},
        lens_(input.rig),
        prior_(PriorOf(input.rig, options)),
        refined_(input.refined),
        correction_(input.correction) {
    for (const auto& pose : input.world_from_left) {
      bundle_.left_from_world.push_back(pose ? std::optional(pose->Inverse()) : std::nullopt);
    }
  }

  Adjustment Run() {
    // Wide at first: the starting poses are off by more than the pixels are.
    constexpr double kStartErrorPx = 8.0;
    double max_error_px = kStartErrorPx;
    const auto adjust = [&](double function_tolerance) {
      Round(max_error_px, function_tolerance);
      max_error_px = options_.outlier_sigmas * noise_px_;
    };
    for (int round = 1; round < options_.rounds; ++round) adjust(kRoughTolerance);
    constexpr int kMaxCorrections = 16;
    for (int i = 0; i < kMaxCorrections && CorrectRig(); ++i) adjust(kRoughTolerance);
    const bool is_final = !input_.is_provisional || correction_.isZero();
    bool gives = false;
    for (int i = 0; is_final && i < kMaxCorrections && FollowFlexure(); ++i) {
      adjust(kRoughTolerance);
      gives = true;
    }
    for (int i = 0; gives && i < kMaxCorrections && CorrectRig(); ++i) adjust(kRoughTolerance);
    if (is_final) {
      for (int i = 0; i < kMaxCorrections && DescribeLens(); ++i) adjust(kRoughTolerance);
    }
    adjust(is_final ? kFineTolerance : kRoughTolerance);
    return Result(SolveSystem());
  }

 private:
  void Round(double max_error_px, double function_tolerance) {
    bundle_.points = TriangulateWithin(max_error_px);
    KeepGroupsApart();
    if (bundle_.points.empty()) return;
    SolveBundle(options_.huber_sigmas * noise_px_, function_tolerance, bundle_);
    const auto errors = ErrorsPx(bundle_);
    noise_px_ = std::max(options_.min_noise_px, NoisePx(errors, bundle_));
    DropBeyond(options_.outlier_sigmas * noise_px_, errors, bundle_);
    KeepGroupsApart();
    spdlog::info("noise {:.3f} px, {} points, {} of {} observations dropped", noise_px_,
                 bundle_.points.size(), errors.size() - ObservationCount(bundle_.points),
                 errors.size());
  }

  Linearisation Linearised() const {
    return {bundle_.points,
            bundle_.left_from_world,
            bundle_.rig,
            noise_px_,
            options_.huber_sigmas * noise_px_,
            lens_.Field(),
            lens_.Information(),
            flexure_.IsFound() ? &flexure_ : nullptr};
  }

  CameraSystemResult SolveSystem() const {
    CameraSystemResult system = SolveCameraSystem(Linearised(), input_.references);
    if (!TellsOfTheRig()) system.calibration.reset();
    return system;
  }

  // Shorter paths add nothing to what one frame tells of the rig.
  bool TellsOfTheRig() const { return PathExtent_m(bundle_) >= bundle_.rig.Baseline(); }

  // False, with nothing changed, where no correction is called for or the last one has settled.
  bool CorrectRig() {
    if (!TellsOfTheRig()) return false;
    const auto solution = SolveCalibration(Linearised());
    if (!solution) return false;
    // More is freed only once what is free has roughly settled: until then it may make up for the
    // rest.
    constexpr double kRoughlySettled = 0.5, kSettled = 0.1;  // what is left counts in the sigmas
    const CalibrationPrior prior =
        AsGoodAsFound(prior_, correction_, solution->equations, options_);
    if (MoveRig(kRoughlySettled, *solution, prior)) return true;
    refined_ = NextRefinement(refined_, correction_, solution->equations, prior, options_);
    return MoveRig(input_.is_provisional ? kRoughlySettled : kSettled, *solution, prior);
  }

  // False, with nothing changed, where the rig does not give, and once its turns have settled.
  bool FollowFlexure() {
    constexpr double kSettledPx = 0.005;
    if (options_.refine_rig != RigRefinement::kAuto || !TellsOfTheRig()) return false;
    const bool is_new = !flexure_.IsFound();
    if (is_new && !flexure_.Begin(Linearised(), options_)) return false;
    const auto solution = SolveCalibration(Linearised());
    if (!solution) return false;
    const CalibrationVector step =
        StepOf(*solution, AsGoodAsFound(prior_, correction_, solution->equations, options_));
    const double largest_px =
        bundle_.rig.right.camera.MeanFocal() * RigFlexure::LargestStep(solution->responses, step);
    if (!is_new && largest_px < kSettledPx) return false;
    Follow(*solution, step);
    return true;
  }

  // To the most probable correction with the parameters of `refined_` free.
  CalibrationVector StepOf(const CalibrationSolution& solution,
                           const CalibrationPrior& prior) const {
    const auto better = MostProbable(refined_, correction_, solution.equations, prior, options_);
    return better ? CalibrationVector(better->correction - correction_) : CalibrationVector::Zero();
  }

  // What is left in the residuals and the same in all frames. False, with nothing changed, where
  // there is no such thing, and once it has settled.
  bool DescribeLens() {
    constexpr double kSettledPx = 0.005;
    if (options_.refine_rig != RigRefinement::kAuto || !TellsOfTheRig()) return false;
    const bool is_new = !lens_.Field();
    if (is_new && !lens_.Begin(Linearised(), options_)) return false;
    const auto solution = SolveCalibration(Linearised());
    if (!solution) return false;
    const CalibrationPrior prior =
        AsGoodAsFound(prior_, correction_, solution->equations, options_);
    const CalibrationVector step = StepOf(*solution, prior);
    if (!is_new && FieldStep(*solution, step).cwiseAbs().maxCoeff() < kSettledPx) return false;
    lens_.TakeSigma(Linearised(), *solution, prior, correction_, options_);
    Follow(*solution, step);
    return true;
  }

  static Eigen::VectorXd FieldStep(const CalibrationSolution& solution,
                                   const CalibrationVector& step) {
    const FieldResponse& response = solution.field->response;
    return response.step + response.by_calibration * step;
  }

  // Moves the rig, the poses and the lens's field with it.
  void Follow(const CalibrationSolution& solution, const CalibrationVector& step) {
    correction_ += step;
    bundle_.rig = Corrected(input_.rig, correction_);
    for (std::size_t i = 0; i < bundle_.left_from_world.size(); ++i) {
      auto& pose = bundle_.left_from_world[i];
      if (pose) pose = Moved(*pose, solution.responses[i], step);
    }
    if (solution.field) lens_.Move(FieldStep(solution, step));
    flexure_.Move(solution.responses, step);
  }

  // To the most probable correction with the parameters of `refined_` free, the poses following;
  // false if no parameter is further from it than `settled` sigmas.
  bool MoveRig(double settled, const CalibrationSolution& solution, const CalibrationPrior& prior) {
    if (refined_ == RigRefinement::kNone) return false;
    const auto better = MostProbable(refined_, correction_, solution.equations, prior, options_);
    if (!better) return false;
    const CalibrationVector step = better->correction - correction_;
    const CalibrationVector sigmas = better->covariance.diagonal().cwiseSqrt();
    if ((step.array().abs() <= settled * sigmas.array()).all()) return false;
    Follow(solution, step);
    spdlog::info("rig corrected, in sigmas of the prior, by {:.3f}",
                 fmt::join(correction_.cwiseQuotient(prior_.sigmas), " "));
    return true;
  }

  std::vector<AdjustedPoint> TriangulateWithin(double max_error_px) const {
    return TriangulateTracks(tracks_, input_.correspondences, bundle_.rig, bundle_.left_from_world,
                             max_error_px, options_.max_depth_baselines * bundle_.rig.Baseline(),
                             lens_.Field(), &flexure_);
  }

  void KeepGroupsApart() {
    DropThinFrames(bundle_);
    SplitBetweenGroups(bundle_.left_from_world.size(), bundle_.points);
    DropUndetermined(bundle_);
    DropThinFrames(bundle_);
  }

  // That of the rig file, as the images find it.
  CalibrationPrior PriorAsFound(const CameraSystemResult& system) const {
    if (!system.calibration) return prior_;
    return AsGoodAsFound(prior_, correction_, *system.calibration, options_);
  }

  // Where the images are not asked, the prior counts.
  CalibrationMatrix ErrorOfCalibration(const CameraSystemResult& system,
                                       const CalibrationPrior& prior) const {
    if (!system.calibration) return prior.information.inverse();
    return CalibrationError(refined_, correction_, *system.calibration, prior, options_);
  }

  Adjustment Result(CameraSystemResult system) {
    Adjustment result;
    const auto errors = ErrorsPx(bundle_);
    result.reprojection_px = errors.empty() ? 0.0 : Median(errors);
    result.noise_px = noise_px_;
    const std::size_t all =
        ObservationCount(TriangulateWithin(std::numeric_limits<double>::infinity()));
    result.outlier_share =
        1.0 - static_cast<double>(errors.size()) /
                  static_cast<double>(std::max({all, errors.size(), std::size_t{1}}));
    const CalibrationPrior prior = PriorAsFound(system);
    result.prior_factor = prior.sigmas(kLogFocal) / prior_.sigmas(kLogFocal);
    const CalibrationMatrix of_calibration = ErrorOfCalibration(system, prior);
    DriftEffect drift;  // none where the images are not asked for the calibration
    if (system.calibration) {
      drift =
          EffectOfDrift(Linearised(), *system.calibration, refined_, correction_, prior, options_);
    }
    result.covariances =
        InflatedCovariances(system, bundle_.left_from_world, options_.shared_noise, of_calibration);
    for (std::size_t i = 0; i < drift.poses.size(); ++i) {
      result.covariances[i] += kShareOfDrift * drift.poses[i] * drift.poses[i].transpose();
    }
    result.link_covariances = InflatedLinks(system, bundle_.left_from_world, options_.shared_noise);
    result.by_calibration = std::move(system.by_calibration);
    result.calibration_covariance = of_calibration;
    if (system.scale) {
      const CalibrationVector& by_calibration = system.scale->by_calibration;
      const double of_noise =
          options_.shared_noise * options_.shared_noise * system.scale->variance +
          kShareOfDrift * drift.scale * drift.scale;
      result.scale_sigma_of_noise = std::sqrt(of_noise);
      result.scale_sigma =
          std::sqrt(of_noise + by_calibration.dot(of_calibration * by_calibration));
    }
    result.correction_px = LargestShiftPx(input_.rig, bundle_.rig);
    result.correction_prior_sigmas = LargestShiftSigmas(input_.rig, bundle_.rig, prior_);
    result.infinity_offset_px = DisparityAtInfinity(bundle_.rig) - DisparityAtInfinity(input_.rig);
    result.infinity_offset_sigma_px =
        SigmaOf(DisparityAtInfinity, input_.rig, correction_, prior_.sigmas,
                of_calibration + kShareOfDrift * drift.calibration * drift.calibration.transpose());
    result.datum_frames = std::move(system.datum_frames);
    result.calibration = system.calibration;
    if (system.calibration) {
      result.calibration_inflation = Inflation(*system.calibration, options_);
    }
    result.rig = bundle_.rig;
    const LensField* field = lens_.Field();
    result.lens_field_rms_px = field ? field->RmsPx() : 0.0;
    result.rig.left.lens_field = field ? std::optional(field->Of(Eye::kLeft)) : std::nullopt;
    result.rig.right.lens_field = field ? std::optional(field->Of(Eye::kRight)) : std::nullopt;
    result.right_turns = flexure_.Turns();
    result.rig_correction = correction_;
    result.rig_correction_sigmas = correction_.cwiseQuotient(prior_.sigmas);
    result.refined = refined_;
    for (const auto& pose : bundle_.left_from_world) {
      result.world_from_left.push_back(pose ? std::optional(pose->Inverse()) : std::nullopt);
    }
    result.points = std::move(bundle_.points);
    return result;
  }

  const AdjustmentInput& input_;
  const AdjustmentOptions& options_;
  std::vector<Track> tracks_;
  Bundle bundle_;
  LensDescription lens_;
  RigFlexure flexure_;
  CalibrationPrior prior_;
  RigRefinement refined_;
  CalibrationVector correction_;
  double noise_px_ = 1.0;
};

}  // namespace

Adjustment AdjustBundle(const AdjustmentInput& input, const AdjustmentOptions& options) {
  return Adjuster(input, options).Run();
}

}  // namespace rigmap
