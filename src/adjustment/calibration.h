// Where the images of a part would move the rig's calibration, and how far to follow them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "adjustment/adjustment_options.h"
#include "scene/calibration.h"
#include "scene/rig.h"

namespace rigmap {

StereoRig Corrected(const StereoRig& rig, const CalibrationVector& correction);
// The correction that makes `to` of `from`, where there is one.
CalibrationVector CorrectionBetween(const StereoRig& from, const StereoRig& to);

// The step that rotation and common focal factor would take together, all else held. Its sigmas are
// inflated as those of poses are, because residuals of one track are correlated; errors that a
// wrong rig leaves in the residuals are correlated as well. How well the path could determine the
// step at all, the sigmas of independent residuals say.
struct CalibrationStep {
  Eigen::Vector3d rig_rotation = Eigen::Vector3d::Zero(),
                  rig_rotation_sigma = Eigen::Vector3d::Zero(),
                  rig_rotation_sigma_if_independent = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rig_rotation_correlation =
      Eigen::Matrix3d::Zero();  // of independent observations
  double log_focal, log_focal_sigma, log_focal_sigma_if_independent;
};

// Nothing where the equations are singular.
std::optional<CalibrationStep> RotationAndFocalStep(const CalibrationEquations& equations);

// How many times as uncertain (variance) as independent observations would leave them the equations
// are: because residuals of one track go together, because of noise that tracks share, because
// stretches or regions contradict each other by more than that, and because of what all windows
// have in common.
double Inflation(const CalibrationEquations& equations, const AdjustmentOptions& options);
// By the first two of these, the second as it counts for poses.
double InflationOfPoses(const CalibrationEquations& equations, const AdjustmentOptions& options);

// Where the right eye sees what the left one sees at `left` if it is infinitely far; nothing where
// either lens model has no such ray.
std::optional<Eigen::Vector2d> RightPixelAtInfinity(const StereoRig& rig,
                                                    const Eigen::Vector2d& left);
// Disparity there of what is infinitely far, in the middle of the left image, px.
double DisparityAtInfinity(const StereoRig& rig);
// Sigma of a function of the rig as `correction` corrects it, when the correction has this
// covariance.
double SigmaOf(double (*function)(const StereoRig&), const StereoRig& rig,
               const CalibrationVector& correction, const CalibrationVector& prior_sigmas,
               const CalibrationMatrix& covariance);
// Largest change of RightPixelAtInfinity over the image, px.
double LargestShiftPx(const StereoRig& from, const StereoRig& to);
// Largest ratio of that change to its length that the prior of a correction of `from` expects there
// (root mean square): what is far for the middle of an image is not for its corners.
double LargestShiftSigmas(const StereoRig& from, const StereoRig& to,
                          const CalibrationPrior& prior);

// Where a right eye would see without its turn (rad, about its own axes) what it sees at this
// pixel; the pixel itself where that has no ray.
Eigen::Vector2d Steadied(const Camera& right, const Eigen::Vector3d& turn,
                         const Eigen::Vector2d& pixel);
// How far turns of the right eye, one per frame, move its image about its mean: root mean
// squares of what turns about x, y and z do at the middle of the image, those about z at the root
// mean square distance from it. Zero without turns.
Eigen::Vector3d FlexurePx(const Camera& right, const std::vector<Eigen::Vector3d>& turns);

// The prior of a rig file that may be worse or better than files usually are. How much is told by
// what the images find of it, all but the common focal length: the factor on the prior's covariance
// that makes it most probable (MacKay 1992), where the quality of files is known only as five
// parameters would tell it (inverse chi-square). A file off in what can be seen is taken to be off
// in what cannot.
CalibrationPrior AsGoodAsFound(const CalibrationPrior& prior, const CalibrationVector& now,
                               const CalibrationEquations& equations,
                               const AdjustmentOptions& options);

// A correction with what the part and the prior together leave unknown of it.
struct ProbableCorrection {
  CalibrationVector correction;
  CalibrationMatrix covariance;  // zero where a parameter is held
};

// The most probable correction under the prior when the parameters of `refined` are free, given
// what the part says at the correction `now`. Nothing where the equations are singular.
std::optional<ProbableCorrection> MostProbable(RigRefinement refined, const CalibrationVector& now,
                                               const CalibrationEquations& equations,
                                               const CalibrationPrior& prior,
                                               const AdjustmentOptions& options);
// The same with another inflation than Inflation's.
std::optional<ProbableCorrection> MostProbable(RigRefinement refined, const CalibrationVector& now,
                                               const CalibrationEquations& equations,
                                               const CalibrationPrior& prior, double inflation);

// Mean square error of the calibration at the correction `now`, in which the parameters of
// `refined` are free: what the part and the prior leave unknown, and how far the most probable
// correction lies from it. Regions of the image that ask for different focal lengths leave it as
// uncertain as a jackknife over them tells (delete one region, Efron and Stein 1981). Where the
// images ask for one that left-out stretches or regions contradict, or beside a field of the lens,
// they do not know it: half of what they ask for, but for noise, may be its error; where they ask
// for less it is what two sigmas of noise would make of it, and at most the prior's sigma;
// the sigma is no less than half of what they ask for.
// Where the equations are singular the prior counts.
CalibrationMatrix CalibrationError(RigRefinement refined, const CalibrationVector& now,
                                   const CalibrationEquations& equations,
                                   const CalibrationPrior& prior, const AdjustmentOptions& options);

// The same for other parts. Where such a focal length is held, the rest makes up for it as this
// path wants it; how another path would have it, nobody knows.
CalibrationMatrix CalibrationErrorElsewhere(RigRefinement refined, const CalibrationVector& now,
                                            const CalibrationEquations& equations,
                                            const CalibrationPrior& prior,
                                            const AdjustmentOptions& options);

// How much better blocks of the observations fit a rig that is corrected from all the others: half
// the decrease of their weighted squares, in units of what chance gives (InflationOfPoses: in
// doubt, parameters are held).
struct LeftOutGain {
  double sum = 0.0;  // over all blocks
  int blocks = 0;
  int against = 0;  // blocks that fit worse, by more than chance

  void Add(double gain) {
    constexpr double kChance = 0.5;  // half a square of one sigma
    sum += gain;
    if (gain < -kChance) ++against;
  }
};
// `blocks` are the stretches or the regions of `equations`. Nothing for less than four.
std::optional<LeftOutGain> GainOfRefining(RigRefinement from, RigRefinement to,
                                          const CalibrationVector& now,
                                          const CalibrationEquations& equations,
                                          const std::vector<CalibrationBlock>& blocks,
                                          const CalibrationPrior& prior,
                                          const AdjustmentOptions& options);

// Which parameters to free, where `now` is the correction with those of `refined` free: what
// options.refine_rig says, for "auto" one step further than `refined` at most. All but the common
// focal length are freed first, where stretches of the part confirm it; the focal length must not
// make up for what the lens model lacks, so regions of the image have to confirm it as well.
RigRefinement NextRefinement(RigRefinement refined, const CalibrationVector& now,
                             const CalibrationEquations& equations, const CalibrationPrior& prior,
                             const AdjustmentOptions& options);

}  // namespace rigmap
