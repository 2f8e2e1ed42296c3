// Poses that agree best with each other and with fixes of a satellite receiver.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid3.h"
#include "scene/trajectory.h"

namespace rigmap {

// Where a receiver found the antenna.
struct AntennaFix {
  double time_s = 0.0;  // by the poses' clock, as far as it is known: since the first pose
  Eigen::Vector3d x_in_enu = Eigen::Vector3d::Zero();  // metres
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Ones();
};

// Of the step to each pose, where anything is known of it: translation (m), rotation (rad). What
// counts is how they compare.
using StepCovariances = std::vector<std::optional<Matrix6d>>;

struct FixFusion {
  Eigen::Vector3d antenna_in_left = Eigen::Vector3d::Zero();
  Rigid3 enu_from_world;  // where the search begins: its heading must be right to some degrees
  // Of the path's length, which no step knows better: one sigma, relative.
  double scale_sigma = 0.0;
  // Of what is left of the clock's offset; nothing: the path cannot tell it, and it is held.
  std::optional<double> clock_sigma_s;
  double max_gap_s = 3.0;                 // poses further apart have nothing between them
  StepCovariances step_covariances = {};  // none: all steps alike
};

struct FusedFixes {
  std::vector<Rigid3> world_from_left;  // as given: the first measured is as it was
  Rigid3 enu_from_world;
  double scale = 1.0;           // by which the path was lengthened
  double clock_offset_s = 0.0;  // beside what is in the fixes' times: of a fix minus the poses'
  std::vector<char> used;       // per fix; not 0 where it was believed
  // Of the solution: the sum of squared errors in sigmas, of steps and of the fixes believed, and
  // how many there are beyond what was solved for. About equal, where both say what they are.
  double chi2 = 0.0;
  int degrees_of_freedom = 0;
  double fix_noise_factor = 1.0;  // of the stated sigmas, which were raised by it where above 1
  double chi2_as_stated = 0.0;    // the same sum with the fixes' sigmas as they were stated
};

// Steps keep the motion of the poses given. How far each may be off follows from what the poses
// say of themselves: a random walk of headings and positions that grows to the sigmas of the least
// known one that was measured, most in the steps that are known least, and the scale in common;
// those predicted are as loose as they say, and no fix lies beside them. Heading, inclination,
// origin and scale are solved with all poses; the first measured pose is held in its world, which
// only fixes tie to the Earth. Fixes pull under Cauchy's loss first; those further off than noise
// has them once in 16 000 are then left out, anew until it stays the same (Ceres, one thread: equal
// input gives equal output). `poses` has two or more. Nothing where fewer than four fixes lie
// between measured poses, fewer than two thirds of them are believed, or the search does not
// settle.
std::optional<FusedFixes> FuseFixes(const Trajectory& poses, const std::vector<AntennaFix>& fixes,
                                    const FixFusion& fusion);

// The antenna at that time, between measured poses; nothing outside them or in a gap.
std::optional<Eigen::Vector3d> AntennaAt(const Trajectory& poses, double time_s,
                                         const Eigen::Vector3d& antenna_in_left, double max_gap_s);

}  // namespace rigmap
