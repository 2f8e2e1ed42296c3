// One rig for many parts.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/calibration.h"

namespace rigmap {

// What one part says: its equations at its own correction of the common rig file.
struct CalibrationWitness {
  CalibrationVector correction = CalibrationVector::Zero();
  CalibrationEquations equations;
};

// Three sigmas in every parameter. Chance alone would stay below kSquareByChance (99.9 % of chi
// square with nineteen degrees of freedom), but a rig that is used gives a little: halves of one
// drive in a sand yard differ by 1.3, those of a car's by 4.
inline constexpr double kSameRigSquare = 9.0;
inline constexpr double kSquareByChance = 2.4;

// How a part compares with the others.
struct WitnessComparison {
  ProbableCorrection alone;   // what it says by itself, under the prior
  ProbableCorrection others;  // what all others say; the prior itself where there are none
  // Square of the difference in units of what both leave unknown, per free parameter: 1 is expected
  // of the same rig, and never more than kSameRigSquare.
  double square_per_parameter = 0.0;
  // Of the differences of single parameters, in sigmas of what both leave unknown.
  double largest_sigmas = 0.0;
  // The rig for this part: what PoolCalibrations finds without it. Of all parameters, as the pool's
  // own; the prior's where there are no others.
  ProbableCorrection without;
};

struct PooledCalibration {
  RigRefinement refined = RigRefinement::kNone;  // which parameters the parts together tell
  ProbableCorrection pooled;  // of all parameters: what is held counts in the covariance as well
  std::vector<WitnessComparison> parts;
  // Of the rig from one part to the next, beyond what each leaves unknown: a rig gives. In the
  // covariances above as far as another part's rig differs by it.
  CalibrationMatrix between = CalibrationMatrix::Zero();
};

// The correction that the parts tell, and what of all parameters they leave unknown under the
// prior; of no parts, none. Nothing where the equations are singular.
std::optional<ProbableCorrection> PooledCorrection(const std::vector<CalibrationWitness>& parts,
                                                   const CalibrationPrior& prior,
                                                   const AdjustmentOptions& options);

// The most probable correction of the rig file given what all parts say, stretches of all of them
// being left out in turn as in one part. A focal length that a part holds beside a field of its
// lens stays held. The prior counts once. How far rigs differ between parts is told by how far each
// part is from all others beyond what both leave unknown, in the mean of the parts, as a share of
// the prior's covariance (a model of random effects, DerSimonian and Laird 1986); one part tells
// nothing of it. Nothing where the equations are singular. Parts of the same rig file only; at
// least one.
std::optional<PooledCalibration> PoolCalibrations(const std::vector<CalibrationWitness>& parts,
                                                  const CalibrationPrior& prior,
                                                  const AdjustmentOptions& options);

}  // namespace rigmap
