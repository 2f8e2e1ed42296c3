// A trajectory laid on the fixes of a satellite receiver.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "core/options.h"
#include "georeference/geodetic.h"
#include "georeference/rigid2.h"
#include "scene/survey.h"
#include "scene/trajectory.h"

namespace rigmap {

// What each option does and why it has its default: the declaration in rtk_alignment.cc.
struct RtkAlignmentOptions {
  static constexpr const char* kSection = "georeference";

  double max_clock_offset_s = 3.0;
  double max_place_sigma_m = 0.05;
  double max_gap_s = 3.0;
  double unknown_clock_sigma_s = 0.5;

  OptionFields Fields();
};

// The plane is x east, y north (m) of LocalFrame(plane_origin).
struct RtkAlignment {
  Geodetic plane_origin;
  Rigid2 plane_from_world;
  // Stamp of a fix minus the stamp that the images' clock gives to the same moment. Without a sigma
  // it is held at 0, being exact or not determined: along a line or circle driven at constant speed
  // it cannot be told from a motion of the plane.
  double clock_offset_s = 0.0;
  std::optional<double> clock_offset_sigma_s;
  // Horizontal distance of the used fixes from the path laid on them: of the fit, no score.
  double rms_residual_m = 0.0;
  // Fixes during the part: those that determined the alignment; outliers, also of the path where it
  // strays from most fixes, and those that are not RTK_FIXED.
  int used = 0, rejected = 0;
  Eigen::Vector2d world_centre = Eigen::Vector2d::Zero();  // mean antenna position
  // Of the plane's coordinates (m) of world_centre and the angle (rad). Stated sigmas that are too
  // small for the residuals are scaled up to them. Residuals are taken as independent: a path that
  // drifts by more than its fixes scatter leaves this, and the clock's sigma, too small.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double unknown_clock_sigma_m = 0.0;  // what a clock offset that is not determined adds

  // One sigma (m) per axis of where the plane has a horizontal place of the world.
  double SigmaAt(const Eigen::Vector2d& x_in_world) const;
};

struct RtkFit {
  std::optional<RtkAlignment> alignment;
  // Where there is none, or its clock offset is held and not exact: why, a sentence.
  std::string why;
  bool is_weak = false;  // AlignToRtkWeakly gave what AlignToRtk would not
};

// The horizontal motion and clock offset that lay the antenna's path on the fixes: a search over
// offsets by a robust fit, then Gauss-Newton on the fixes within four sigmas, weighted by theirs. A
// motion takes three fixes, an offset four, and each must be determined as the options say. Fixes
// in any order; a trajectory may be empty. Throws UsageError for options out of range.
RtkFit AlignToRtk(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                  const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options = {});

// The same or, where it gives none, with less asked of it: the clock held at 0, a place known to
// `max_place_sigma_m`. `why` says then why AlignToRtk gives none. For what has to be laid on fixes
// though it may stray from them.
RtkFit AlignToRtkWeakly(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                        const Eigen::Vector3d& antenna_in_left, const RtkAlignmentOptions& options,
                        double max_place_sigma_m);

// Of fixes that fit the path only where latitude and longitude are exchanged, as their file may
// have them: a sentence that says so. Such fixes show the path mirrored and stretched, to which a
// straight one due north or east is blind. Empty for fixes that fit as they are or not at all.
std::string FitOnlyExchanged(std::span<const GnssFix> fixes, const Trajectory& trajectory,
                             const Eigen::Vector3d& antenna_in_left,
                             const RtkAlignmentOptions& options = {});

}  // namespace rigmap
