// Poses, points and rig as bundle adjustment leaves them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "scene/calibration.h"
#include "scene/rig.h"
#include "scene/trajectory.h"

namespace rigmap {

struct PointObservation {
  int frame = 0;
  int feature = 0;
  Eye eye = Eye::kLeft;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(frame, feature, eye, pixel);
  }
};

struct AdjustedPoint {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::vector<PointObservation> observations;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(x, observations);
  }
};

struct Adjustment {
  // Metres, in the adjustment's own gauge; nothing for frames that were not adjusted.
  std::vector<std::optional<Rigid3>> world_from_left;
  // Per frame, its datum frame, whose pose was held: the first frame of its connected group. Itself
  // for the frames held and those without points.
  std::vector<int> datum_frames;
  // Of world_from_left relative to the frame's datum frame, about the gauge's axes: translation
  // (m), then rotation (rad). Inflated for correlated residuals and for a corrected rig. Empty
  // where nothing is known of them, as for poses that only COLMAP has adjusted.
  std::vector<Matrix6d> covariances;
  // Of each frame's motion against its reference (AdjustmentInput), as the noise of the images
  // leaves it, about the same axes: poses far from their datum err together, so that the
  // covariances of two neighbours say next to nothing of the motion between them. Nothing where not
  // asked for.
  std::vector<std::optional<Matrix6d>> link_covariances;
  // What of the covariances all frames share: by how much an error of the calibration moves the
  // same poses, and that error's covariance. Empty where the images say nothing of the calibration.
  std::vector<PoseCalibration> by_calibration;
  CalibrationMatrix calibration_covariance = CalibrationMatrix::Zero();
  std::vector<AdjustedPoint> points;
  StereoRig rig;                                 // as calibrated, unless the part corrected it
  RigRefinement refined = RigRefinement::kNone;  // which of its parameters were free
  // By how much it was corrected, also in sigmas of the prior; zero if it was not.
  CalibrationVector rig_correction = CalibrationVector::Zero();
  CalibrationVector rig_correction_sigmas = CalibrationVector::Zero();
  // How many times as far off as files are the rig file was taken to be, by what the images find of
  // it; 1 where they are not asked.
  double prior_factor = 1.0;
  // By how much the correction moves the right image of what is infinitely far: the largest shift
  // of any pixel, the largest over what the prior expects of that pixel, and the change of
  // disparity in the middle of the image with the sigma of what is in use, corrected or not.
  double correction_px = 0.0, correction_prior_sigmas = 0.0, infinity_offset_px = 0.0,
         infinity_offset_sigma_px = 0.0;
  // Of the factor that a similarity alignment would find between the adjusted and the true
  // positions: what noise and calibration leave unknown of it. Nothing for positions that hang on
  // several datum frames or do not differ.
  std::optional<double> scale_sigma;
  // What of that a perfect calibration would leave; there whenever scale_sigma is.
  std::optional<double> scale_sigma_of_noise;
  // Of the displacements that mend what the lens model does not describe; zero if none were called
  // for. Observations are where these have moved them.
  double lens_field_rms_px = 0.0;
  // Per frame, by how much a rig that gives had turned its right eye away from `rig`, about that
  // eye's axes (rad): the eye's coordinates are its turn times what `rig` says. Empty where it is
  // stiff. Observations are where a stiff rig would have made them.
  std::vector<Eigen::Vector3d> right_turns;
  double noise_px = 0.0;         // robust sigma of one residual coordinate
  double reprojection_px = 0.0;  // median distance
  double outlier_share = 0.0;    // of all observations of tracks in the posed frames
  // Nothing on a path shorter than the baseline, which adds nothing to what one frame tells of the
  // rig, however many frames repeat it.
  std::optional<CalibrationEquations> calibration;
  // How many times as uncertain (variance) as independent observations would leave them these are.
  double calibration_inflation = 1.0;

  bool IsRigCorrected() const { return !rig_correction_sigmas.isZero(); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(world_from_left, datum_frames, covariances, link_covariances, by_calibration,
            calibration_covariance, points, rig, refined, rig_correction, rig_correction_sigmas,
            prior_factor, correction_px, correction_prior_sigmas, infinity_offset_px,
            infinity_offset_sigma_px, lens_field_rms_px, right_turns, scale_sigma,
            scale_sigma_of_noise, noise_px, reprojection_px, outlier_share, calibration,
            calibration_inflation);
  }
};

}  // namespace rigmap
