// The normal equations of an adjustment with the points eliminated. Of this room only.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adjustment/internal/lens_field.h"
#include "adjustment/internal/score_clusters.h"
#include "scene/adjustment.h"

namespace rigmap {

class RigFlexure;

// What is linearised, and how observations are weighted: as Huber's loss at `huber_px` does, the
// noise being `noise_px`. Pixels of points have been moved by the field, if there is one;
// `field_information` is what its prior says of each of its parameters (1/px^2).
struct Linearisation {
  const std::vector<AdjustedPoint>& points;
  const std::vector<std::optional<Rigid3>>& left_from_world;
  const StereoRig& rig;
  double noise_px = 1.0, huber_px = 1.0;
  const LensField* field = nullptr;
  double field_information = 0.0;
  const RigFlexure* flexure = nullptr;  // found, if any: its turns are unknown
  // Of what windows slide by over ground that is not flat: px by which both eyes' positions of a
  // point are off, for each unit by which the view departs from that of its first frame (angle of
  // the ray, rad, and logarithm of the ratio of distances, root of the sum of squares). Each point
  // has two such coordinates, which are eliminated with it. 0: windows stay.
  double drift_sigma_px = 0.0;

  double WeightOf(const Eigen::Vector2d& residual) const {
    return std::min(1.0, huber_px / std::max(residual.norm(), 1e-9)) / (noise_px * noise_px);
  }
};

// Unknowns are the poses of frames that are not held and turns of the right eye, if there is
// flexure, in order of frames, and the calibration. A turn is a rotation whose last three
// coordinates nothing moves.
struct ReducedSystem {
  std::vector<int> datum_frames;  // per frame (DatumFrames)
  std::vector<int> unknown;       // per frame; nothing (-1) of a datum frame or one without points
  std::vector<int> turn;          // the same of turns; nothing (-1) without flexure or points
  int unknowns = 0, turns = 0;    // of both together; of turns

  std::map<std::pair<int, int>, Matrix6d> blocks;  // row, column: lower triangle
  // Per unknown: coupling, gradient.
  std::vector<PoseCalibration> pose_calibration;
  std::vector<Vector6d> pose_gradient;
  CalibrationMatrix calibration = CalibrationMatrix::Zero();
  CalibrationVector calibration_gradient = CalibrationVector::Zero();
  // A track is a cluster: all its positions are aligned with one patch, or with each other's.
  ScoreClusters clusters;
  double coordinates = 0.0, point_unknowns = 0.0;

  bool IsUnknown(std::size_t frame) const { return unknown[frame] >= 0; }
  // Share of the coordinates' freedom that the unknowns leave.
  double Redundancy() const;
};

// Points are shared out in a fixed number of parts, which are added up in order: the result does
// not depend on the number of threads.
ReducedSystem AssembleReducedSystem(const Linearisation& at);

}  // namespace rigmap
